"""The specification as text, with its problems, and the files that a page loads."""

from __future__ import annotations

import asyncio
import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Literal

from nicegui import background_tasks, events, ui

from metafem.errors import InvalidInput, refuse_if
from metafem.explorer.answer import Answer
from metafem.explorer.control import Control, Panel
from metafem.explorer.history import State
from metafem.explorer.law_data import read_points
from metafem.explorer.table import section_of
from metafem.surface import Surface

# Name of the specification in a result folder.
KEPT = "spec.toml"

# Largest file that is read [bytes]: a link holds no more.
LARGEST = 900_000

# Time after the last key after which a typed text is used [s].
TYPED = 0.5

# Colours of the syntax, which `page.css` inverts on a dark page.
COLOURS: Literal["githubLight"] = "githubLight"

# What is said beside the button for files.
DROP = "A specification, its tables or a measured law can be dropped onto the page."

# Opens the browser's dialog for files.
PICK = "() => document.querySelector('.q-uploader input').click()"


# A file that the user selected or dropped: its ``name``, and its ``text`` or ``why`` it could not be read.
Given = Mapping[str, str]


def uploader(page: Control) -> ui.upload:
    """Return the element, not seen, to which the browser gives the files that were selected or dropped."""

    async def take(event: events.MultiUploadEventArguments) -> None:
        element.reset()
        files = [await _read(file) for file in event.files]
        await page.told(page.step(lambda state: loaded(state, files, page.answer.template)))

    element = ui.upload(multiple=True, auto_upload=True, on_multi_upload=take)
    element.on("failed", lambda: page.say("The files could not be read."), args=[])
    return element.classes("hidden")


async def _read(file: Any) -> Given:
    if file.size() > LARGEST:
        return {"name": file.name, "why": f"is larger than {LARGEST // 1000} kB, the limit for a file"}
    try:
        return {"name": file.name, "text": await file.text()}
    except UnicodeDecodeError:
        return {"name": file.name, "why": "is not a text in UTF-8"}


def loaded(state: State, files: list[Given], template: Surface | None = None) -> State:
    """Return the state with the specification in the files, with tables that it names, or a measured law.

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
        name, text = next(iter(tables.items()))
        refuse_if(len(tables) > 1, f"{name} and others are tables. Load the one with a measured law alone.")
        if template is None:
            words = f"The points of the table {name} can be shown once the specification has no problems."
            raise InvalidInput(words)
        read_points(name, text, template.material, template.friction)
        return replace(state, measured=text, measured_name=name)
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
                load = ui.element("button").classes("act").on("click", js_handler=PICK)
                with load:
                    ui.label("Load…")
                self.tables = ui.label().classes("quiet small")
                ui.label(DROP).classes("quiet small")
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
        self.problems.text, self.tables.text = answer.refused, ", ".join(answer.state.tables)
        self.problems.set_visibility(bool(answer.refused))
        if self.editor is not None:
            self.editor.value = self.shown
