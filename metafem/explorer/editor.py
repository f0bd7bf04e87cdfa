"""The specification as text, with its problems, and the files that a page loads."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from metafem.errors import InvalidInput, refuse_if
from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel, Widget
from metafem.explorer.history import State
from metafem.explorer.table import section_of

# Name of the specification in a result folder.
KEPT = "spec.toml"


# A file that the user selected or dropped: its ``name``, and its ``text`` or ``why`` it could not be read.
Given = Mapping[str, str]


async def load(page: Control, files: list[Given]) -> None:
    """Show the specification in loaded files, or a message why they cannot be used."""
    await page.told(page.step(lambda state: loaded(state, files)))


def loaded(state: State, files: list[Given]) -> State:
    """Return the state with the specification in the files, or with new tables for the old specification.

    Raises
    ------
    InvalidInput
        If no file is a specification or table that can be used; the message states the reason.
    """
    unread = {each["name"]: each["why"] for each in files if each.get("why")}
    texts = {each["name"]: each["text"] for each in files if each["name"] not in unread}
    specifications = {name: text for name, text in texts.items() if name.lower().endswith(".toml")}
    tables = {name: text for name, text in texts.items() if name.lower().endswith((".csv", ".txt", ".tsv"))}
    if KEPT in specifications:
        specifications = {KEPT: specifications[KEPT]}
    words = "These are several specifications. Load one of them, with its tables."
    refuse_if(len(specifications) > 1, words)
    for name, text in specifications.items():
        found = State(text)
        for each, why in unread.items():
            refuse_if(_named(found, {each: ""}), f"{name} names the table {each}, which {why}.")
        return replace(state, text=text, tables=_named(found, tables))
    if named := _named(state, tables):
        return replace(state, tables={**state.tables, **named})
    if tables:
        table, known = next(iter(tables)), ", ".join(table_names(state)) or "no table"
        raise InvalidInput(
            f'{table} is a table. The specification names {known}. To use it, write file = "{table}" into '
            "[target] or [contact] first. To compare with a measured law, drop it onto the plot of the law."
        )
    reasons = [f"{name} {why}." for name, why in unread.items()]
    reasons += [f"{name} is no specification." for name in texts]
    remedy = f"Load a .toml file, such as the {KEPT} of a result folder, with the tables that it names."
    raise InvalidInput(" ".join([*reasons, remedy]))


def table_names(state: State) -> list[str]:
    """Return the file names of the tables that a specification refers to.

    Examples
    --------
    >>> table_names(State('[target]\\nfile = "wanted.csv"'))
    ['wanted.csv']
    """
    found = [section_of(state.known, name).get("file") for name in ("target", "cap", "contact")]
    return [name for name in found if isinstance(name, str)]


def _named(state: State, tables: Mapping[str, str]) -> dict[str, str]:
    """Return the tables that a specification refers to, by the names in the specification."""
    last = {name: re.split(r"[/\\]", name)[-1] for name in table_names(state)}
    return {name: tables[part] for name, part in last.items() if part in tables}


# Line number in a message of the TOML parser.
LINE = re.compile(r"\bline (\d+)")

# A dotted key.
DOTTED = re.compile(r"[\w-]+(?:\.[\w-]+)+")

HEADER = re.compile(r"\s*\[\s*([^\[\]]+?)\s*\]\s*(?:#.*)?")


class Editor(Widget, component="static/editor.js"):
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
