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


def line_of(text: str, key: str) -> int:
    """Return the line number of a key or, if it is missing, of its section, from 1; 0 if both are missing.

    Examples
    --------
    >>> text = "[limits]\\nmax_height = '120'\\n[model]"
    >>> line_of(text, "limits.max_height"), line_of(text, "limits.offset"), line_of(text, "block.width")
    (2, 1, 0)
    """
    return _nearest(lines_of(text), key)


def lines_of(text: str) -> dict[str, int]:
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


def _nearest(lines: Mapping[str, int], key: str) -> int:
    """Return the line number of a key or, if it is missing, of the innermost section around it."""
    while key and key not in lines:
        key = key.rpartition(".")[0]
    return lines[key]


def placed(text: str, problems: Mapping[str, str], refusal: str = "") -> list[dict[str, Any]]:
    """Return the problems of a text with their line numbers, in the order of the lines."""
    given = list(problems.items()) + ([("target", refusal)] if refusal else [])
    found, lines = [], lines_of(text)
    for key, words in given:
        for each in words.splitlines():
            said, named = LINE.search(each), DOTTED.match(each)  # the message itself names an unknown key
            line = int(said[1]) if said and not key else _nearest(lines, named[0] if named else key)
            found.append({"line": line, "key": key, "words": each})
    return sorted(found, key=lambda problem: int(problem["line"]))
