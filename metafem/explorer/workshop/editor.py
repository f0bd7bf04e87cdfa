"""The specification as text, and the positions of its problems in it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel
from metafem.explorer.widget import Widget
from metafem.explorer.workshop.loading import load

# Line number in a message of the TOML parser.
LINE = re.compile(r"\bline (\d+)")

# A dotted key.
DOTTED = re.compile(r"[\w-]+(?:\.[\w-]+)+")

HEADER = re.compile(r"\s*\[\s*([^\[\]]+?)\s*\]\s*(?:#.*)?")


class Editor(Widget, component="editor.js"):
    """Text editor that marks the problems of the text; emits events when it is ready, and for changes."""


class Specification(Panel):
    """The text of the specification of a page; it is updated with each answer while its tab is open."""

    pace = 0.3

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.taken = 0  # number of the last text that was typed
        self.editor = Editor(
            ready=lambda _: page.renew(self),
            changed=self._changed,
            load=lambda given: load(page, given["files"]),
        )

    async def _changed(self, given: Mapping[str, Any]) -> None:
        text, self.taken = given["text"], given["count"]
        if text != self.page.state.text:
            await self.page.alter(text=text, by=self)

    def prepare(self, answer: Answer) -> dict[str, Any] | None:
        """Return the text of an answer, its problems with their lines, and the names of its tables."""
        if not self.open:
            return None
        state = answer.state
        problems = placed(state.text, answer.problems, answer.refusal)
        return {"text": state.text, "problems": problems, "tables": list(state.tables)}

    def show(self, answer: Answer, data: dict[str, Any] | None) -> None:
        """Show an answer."""
        if data is not None:
            self.editor.call("show", data | {"taken": self.taken})


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
