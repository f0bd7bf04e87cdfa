"""Positions of the problems of a specification in its text."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

# Line number in a message of the TOML parser.
LINE = re.compile(r"\bline (\d+)")

# A dotted key.
DOTTED = re.compile(r"[\w-]+(?:\.[\w-]+)+")

HEADER = re.compile(r"\s*\[\s*([^\[\]]+?)\s*\]\s*(?:#.*)?")


def placed(text: str, problems: Mapping[str, str], refusal: str = "") -> list[dict[str, Any]]:
    """Return the problems of a text with their line numbers, in the order of the lines.

    The line, from 1, is that of the key or, if it is missing, of the innermost section around it; 0 if both
    are missing.

    Examples
    --------
    >>> placed("[limits]\\nmax_height = '120'", {"limits.offset": "is missing"})
    [{'line': 1, 'key': 'limits.offset', 'words': 'is missing'}]
    """
    given = list(problems.items()) + ([("target", refusal)] if refusal else [])
    found, lines = [], _lines_of(text)
    for key, words in given:
        for each in words.splitlines():
            said, named = LINE.search(each), DOTTED.match(each)  # the message itself names an unknown key
            near = named[0] if named else key
            while near not in lines:
                near = near.rpartition(".")[0]
            found.append(
                {"line": int(said[1]) if said and not key else lines[near], "key": key, "words": each}
            )
    return sorted(found, key=lambda problem: int(problem["line"]))


def _lines_of(text: str) -> dict[str, int]:
    """Return the line numbers of the keys and sections of a text, from 1; 0 for the key ""."""
    section, found = "", {"": 0}
    for number, line in enumerate(text.splitlines(), 1):
        header = HEADER.fullmatch(line)
        if header:
            section = re.sub(r"[\s\"']", "", header[1])
            found.setdefault(section, number)
        elif "=" in line and not line.lstrip().startswith("#"):
            name = re.sub(r"[\s\"']", "", line.partition("=")[0])
            found.setdefault(f"{section}.{name}" if section else name, number)
    return found
