"""The page: what it shows, and how an edit becomes an answer."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from nicegui import ui
from nicegui.element import Element

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, answered
from metafem.explorer.browser import Browser
from metafem.explorer.certainty.background import Tasks
from metafem.explorer.certainty.panel import certainty_panel, place_warnings
from metafem.explorer.divider import Divider
from metafem.explorer.law.panel import law_panel
from metafem.explorer.newest import PATIENCE, PATIENCE_WITH_DRAFTS, Newest, all_told, in_words, prepared
from metafem.explorer.session import Session, State
from metafem.explorer.surface.panel import surface_panel
from metafem.explorer.take.panel import take_panel
from metafem.explorer.text.kinds import with_kind
from metafem.explorer.text.link import from_link, restored
from metafem.explorer.turns import Turns
from metafem.explorer.workshop.editor import editor_panel
from metafem.explorer.workshop.header import header_panel
from metafem.explorer.workshop.panel import workshop_panel

Result = TypeVar("Result")
Told = TypeVar("Told")

Listener = Callable[[Answer], None]

# Number, state, and whether a draft is enough.
Request = tuple[int, State, bool]

# The look of the page, and of its head and fields.
STYLES = ("page.css", "workshop/workshop.css")


class Page:
    """One tab of the browser: its history, the newest answer, and the panels that listen for it."""

    def __init__(self, first: State) -> None:
        self.first = first
        self.session = Session(first)
        self.answer = Answer(0, first)
        self.number = 0
        self.listeners: list[Callable[[Answer], Listener]] = []
        self.late_listeners: list[Listener] = []
        self.tab_listeners: list[Callable[[str], None]] = []
        self.warning_listeners: list[Callable[[Mapping[str, list[str]]], None]] = []
        self.newest: Newest[Request, tuple[Answer, list[Listener]]] = Newest(
            self._work, self._show, self._failed, patience=patience, better=whole_of
        )
        self.browser = Browser(self._restored, self.open_link)
        self.turns = Turns(self.browser.busy)
        self.tasks = Tasks()
        self.client = ui.context.client
        self.client.on_delete(self.tasks.stop_all)
        self.client.on_exception(self.wrong)

    @property
    def state(self) -> State:
        """The state that is shown."""
        return self.session.state

    def listen(self, callback: Listener) -> None:
        """Call a function with every new answer."""
        self.listeners.append(lambda answer: callback)

    def listen_prepared(
        self, prepare: Callable[[Answer], Result], show: Callable[[Answer, Result], None]
    ) -> None:
        """Call a function with every new answer and with what is computed of it off the event loop."""
        self.listeners.append(partial(prepared, prepare, show))

    def listen_late(self, callback: Callable[[Answer], None]) -> None:
        """Call a function when more is known of the answer that is shown: its drawn tolerance band."""
        self.late_listeners.append(callback)

    def listen_tab(self, callback: Callable[[str], None]) -> None:
        """Call a function with the name of the tab that is opened."""
        self.tab_listeners.append(callback)

    def complete(self) -> None:
        """Show what has become known of the answer that is shown."""
        self._tell(self.late_listeners, self.answer)

    def open_tab(self, name: str) -> None:
        """Tell the panels that a tab was opened."""
        self._tell(self.tab_listeners, name)

    def listen_warnings(self, callback: Callable[[Mapping[str, list[str]]], None]) -> None:
        """Call a function with the warnings of an answer by where they belong, when they are known."""
        self.warning_listeners.append(callback)

    def warn(self, places: Mapping[str, list[str]]) -> None:
        """Show the warnings of the answer that is shown."""
        self._tell(self.warning_listeners, places)

    def edit(self, text: str, *, released: bool = True) -> int:
        """Answer another text of the specification; a released one is a step of the history.

        The answer to one that is not released is a draft; after a moment without another, that of the whole
        search follows. Returns the number of the request.
        """
        return self._ask(replace(self.state, text=text), released)

    def change(self, **members: Any) -> int:
        """Answer a state with other members."""
        return self._ask(replace(self.state, **members), True)

    def look(self, **members: Any) -> int:
        """Answer a state that differs in how it is looked at, which is no step of the history."""
        self.session.replace(replace(self.state, **members))
        return self._ask(self.state, True)

    async def make(self, change: Callable[..., str], *given: Any, released: bool = True) -> int | None:
        """Answer the text that a function of the state gives; it is called off the event loop in its turn.

        Returns the number of the request; None for a draft in whose place a newer change was asked for.
        """
        return await self.turns.take(
            lambda: change(self.state, *given), partial(self.edit, released=released), draft=not released
        )

    async def choose_kind(self, kind: str) -> int | None:
        """Answer a target of another kind near the law that is shown, unless another change is asked for."""
        return await self.turns.aside(lambda: with_kind(self.state, self.answer.design, kind), self.edit)

    async def alter(self, **members: Any) -> int | None:
        """Answer a state with other members, after earlier changes."""
        return await self.turns.take(nothing, lambda _: self.change(**members))

    async def undo(self) -> None:
        """Return to the state before."""
        await self.turns.take(nothing, lambda _: self._moved(self.session.undo))

    async def redo(self) -> None:
        """Return to the state that was undone."""
        await self.turns.take(nothing, lambda _: self._moved(self.session.redo))

    async def in_thread(self, function: Callable[..., Result], *given: Any) -> Result:
        """Return the value of a function that is computed off the event loop."""
        return await asyncio.to_thread(function, *given)

    def _moved(self, move: Callable[[], bool]) -> None:
        if move():
            self._ask(self.state, True)

    def _ask(self, state: State, released: bool) -> int:
        self.number += 1
        if released:
            self.session.commit(state)
            self.browser.keep(self.session, self.number)
        self.newest.put((self.number, state, not released))
        return self.number

    def _work(self, request: Request) -> tuple[Answer, list[Listener]]:
        number, state, draft = request
        return self._prepared(answered(state, number, self.answer, draft))

    def _prepared(self, answer: Answer) -> tuple[Answer, list[Listener]]:
        return answer, [listener(answer) for listener in self.listeners]

    def _show(self, found: tuple[Answer, list[Listener]]) -> None:
        self.answer, listeners = found
        self._tell(listeners, self.answer)

    def _failed(self, request: Request, error: Exception) -> None:
        """Show an error of the program, with the last surface that was found."""
        number, state, _ = request
        failed = Answer(number, state, None, self.answer.design, {"": in_words(error)}, failed=True)
        self._show(self._prepared(failed))

    def not_shown(self, request: object, error: Exception) -> None:
        """Say that a part of the page does not follow."""
        self._say_failure(in_words(error))

    def _tell(self, listeners: Iterable[Callable[[Told], None]], value: Told) -> None:
        """Call listeners, and say which errors they made."""
        failures = all_told(listeners, value)
        if failures:
            self._say_failure(failures)

    def wrong(self, error: Exception) -> None:
        """Show an error of the program in what answers a hand or a clock; it is logged elsewhere."""
        self._say_failure(in_words(error))

    def _say_failure(self, words: str) -> None:
        with self.client:
            ui.notify(words, type="negative", multi_line=True, close_button="Close", timeout=0)

    async def open_link(self, link: str) -> None:
        """Show the state of a link, as a step of the history."""
        try:
            await self.turns.take(partial(from_link, link), lambda state: self._ask(state, True))
        except InvalidInput as error:
            ui.notify(str(error), type="warning")

    async def _restored(self, kept: Any) -> None:
        """Show what the browser kept and what the address holds, or the first state."""
        await self.turns.take(partial(restored, kept, self.session), self._begin)

    def _begin(self, found: tuple[Session, str]) -> None:
        self.session, problem = found
        if problem:
            ui.notify(problem, type="warning")
        self._ask(self.state, True)


def nothing() -> None:
    """Compute nothing: a change of the history alone."""


def patience(running: Request, waiting: Request) -> float:
    """Return the seconds that a computation has while a newer request waits.

    A whole search ends at once for a hand that moves on, and goes on for a handle that is released there.
    """
    if running[2]:
        return PATIENCE_WITH_DRAFTS if waiting[2] else PATIENCE
    if running[1].designs_the_same(waiting[1]):
        return math.inf
    return 0.0 if waiting[2] else PATIENCE


def whole_of(request: Request) -> Request | None:
    """Return the request of the whole search for the state of a draft, which a hand at rest waits for."""
    number, state, draft = request
    return (number, state, False) if draft else None


def build(first: State) -> Page:
    """Make the elements of a page that begins with a state."""
    for style in STYLES:
        ui.add_css(Path(__file__).parent.joinpath(style).read_text("utf-8"))
    page = Page(first)
    header_panel(page)
    with ui.element().classes("explorer"):
        with _part("law", "Law"):
            law_panel(page)
            place_warnings(page, "law")
        with _part("surface", "Surface"):
            surface_panel(page)
            place_warnings(page, "surface")
        Divider()
        with _part("below", "Workshop and results"):
            _tabs(page)
    return page


def _part(name: str, label: str) -> Element:
    """Return a part of the page, to which the first link of the page can lead."""
    return ui.element("section").classes(name).props(f'aria-label="{label}" tabindex=-1')


def _tabs(page: Page) -> None:
    panels = {
        "Workshop": workshop_panel,
        "Specification": editor_panel,
        "How sure": certainty_panel,
        "Take it": take_panel,
    }
    with ui.tabs().props(
        'dense no-caps align=left outside-arrows mobile-arrows aria-label="Workshop and results"'
    ) as tabs:
        for name in panels:
            ui.tab(name)
    tabs.on_value_change(lambda event: page.open_tab(event.value))
    with ui.tab_panels(tabs, value="Workshop", animated=False).props("keep-alive").classes("panels"):
        for name, make in panels.items():
            with ui.tab_panel(name):
                partial(make, page)()
