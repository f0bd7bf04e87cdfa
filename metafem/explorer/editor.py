"""The specification as text, with its problems, and the files that a page loads."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Literal

from nicegui import background_tasks, events, ui

from metafem.errors import InvalidInput, refuse_if
from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel
from metafem.explorer.history import State
from metafem.explorer.law_data import read_points
from metafem.explorer.table import section_of
from metafem.files.disk import text_of_table
from metafem.surface import Surface

# Name of the specification in a result folder.
KEPT = "spec.toml"

# Time after the last key after which a typed text is used [s].
TYPED = 0.5

# Colours of the syntax, which `page.css` inverts on a dark page.
COLOURS: Literal["githubLight"] = "githubLight"

# What is said beside the button for files.
DROP = "A specification, its tables or a measured law can be dropped onto the page."

# Opens the browser's dialog for files.
PICK = "() => document.querySelector('.q-uploader input').click()"

# Ends of the names of tables.
TABLES = (".csv", ".txt", ".tsv")


def uploader(page: Control) -> ui.upload:
    """Return the element, not seen, to which the browser gives the files that were selected or dropped."""

    async def read(event: events.MultiUploadEventArguments) -> None:
        element.reset()
        contents = {file.name: await file.read() for file in event.files}
        await page.step(lambda state: loaded(state, texts_of(contents), page.answer.template))

    element = ui.upload(multiple=True, auto_upload=True, on_multi_upload=lambda event: page.told(read(event)))
    element.on("failed", lambda: page.say("The files could not be read."), args=[])
    return element.classes("hidden")


def texts_of(contents: Mapping[str, bytes]) -> dict[str, str]:
    """Return the texts of files by name; tables may have any encoding in which spreadsheets write them."""
    return {
        name: text_of_table(name, raw) if name.lower().endswith(TABLES) else raw.decode("utf-8", "replace")
        for name, raw in contents.items()
    }


def loaded(state: State, texts: Mapping[str, str], template: Surface | None = None) -> State:
    """Return the state with the specification in the files, with tables that it names, or a measured law.

    Raises
    ------
    InvalidInput
        If no file is a specification or table that can be used; the message states the reason.
    """
    specifications = {name: text for name, text in texts.items() if name.lower().endswith(".toml")}
    tables = {name: text for name, text in texts.items() if name.lower().endswith(TABLES)}
    if KEPT in specifications:
        specifications = {KEPT: specifications[KEPT]}
    words = "These are several specifications. Load one of them, with its tables."
    refuse_if(len(specifications) > 1, words)
    for name, text in specifications.items():
        refuse_if("\N{REPLACEMENT CHARACTER}" in text, f"{name} is not a text in UTF-8.")
        return replace(state, text=text, tables=_named(State(text), tables))
    if named := _named(state, tables):
        return replace(state, tables={**state.tables, **named})
    names = ", ".join(texts)
    remedy = f"Load a .toml file, such as the {KEPT} of a result folder, or the table of one measured law."
    refuse_if(len(tables) != 1, f"{names}: no file that can be shown. {remedy}")
    if template is None:
        raise InvalidInput(f"The points of {names} can be shown once the specification has no problems.")
    ((name, text),) = tables.items()
    read_points(name, text, template.material, template.friction)
    return replace(state, measured=text, measured_name=name)


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


class Specification(Panel):
    """The text of the specification, with its problems."""

    pace = 0.3

    def __init__(self, page: Control) -> None:
        super().__init__(page)
        self.shown = page.state.text
        self.editor: ui.codemirror | None = None
        self.timer: asyncio.TimerHandle | None = None  # while something typed is not used yet
        self.classes("editor").on("focusout", self._use, args=[])
        with self:
            with ui.element("div").classes("row"):
                ui.html("Load…", sanitize=False, tag="button").classes("act").on("click", js_handler=PICK)
                self.files = ui.label(DROP).classes("quiet small")
            with ui.element("div").classes("both"):
                self.frame = ui.element("div").classes("frame")
                self.problems = ui.label().classes("problems warn")

    def opened(self) -> None:
        """Make the editor: the browser loads its script when it is first opened."""
        if self.editor is not None:
            return
        with self.frame:
            self.editor = ui.codemirror(self.shown, on_change=self._typed, language="TOML", theme=COLOURS)
        # the key Tab leaves the text, as any other field
        self.editor.on("keydown.tab.capture", js_handler="(event) => event.stopPropagation()")
        self.editor.on("focusin", js_handler="({ target }) => { target.ariaLabel ??= 'Specification'; }")

    def _typed(self) -> None:
        if self.timer is not None:
            self.timer.cancel()
            self.timer = None
        if self.editor is not None and self.editor.value != self.shown:
            loop = asyncio.get_running_loop()
            self.timer = loop.call_later(TYPED, lambda: background_tasks.create(self._use()))

    async def _use(self) -> None:
        """Use what was typed."""
        if self.timer is not None and self.editor is not None:
            self.timer.cancel()
            self.timer, self.shown = None, self.editor.value
            await self.page.alter(text=self.shown, by=self)

    def show(self, answer: Answer, _: object) -> None:
        """Show the text of an answer, unless another one is being typed, with its problems and its tables."""
        if self.timer is not None:
            return
        self.shown = re.sub("\r\n?", "\n", answer.state.text)  # the editor has these ends of lines alone
        self.problems.text, tables = answer.refused, ", ".join(answer.state.tables)
        self.files.text = f"With {tables}. {DROP}" if tables else DROP
        if self.editor is not None:
            self.editor.value = self.shown
