"""The page: what it shows, and how it answers an edit."""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable, Iterable, Mapping
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
from metafem.explorer.law.comparison import COMPARED, comparison_panel
from metafem.explorer.law.panel import law_panel
from metafem.explorer.newest import PATIENCE, PATIENCE_WITH_DRAFTS, Newest, all_told, in_words, prepared
from metafem.explorer.session import Session, State
from metafem.explorer.surface.panel import surface_panel
from metafem.explorer.take.panel import take_panel
from metafem.explorer.text.document import as_own
from metafem.explorer.text.kinds import with_kind
from metafem.explorer.text.link import from_link, restored
from metafem.explorer.text.names import on_page
from metafem.explorer.tour import Tour
from metafem.explorer.turns import Turns
from metafem.explorer.workshop.editor import editor_panel
from metafem.explorer.workshop.header import header_panel
from metafem.explorer.workshop.panel import workshop_panel

Result = TypeVar("Result")
Told = TypeVar("Told")

Listener = Callable[[Answer], None]

# Number of the request, state to answer, and whether a draft is enough.
Request = tuple[int, State, bool]

# Style sheets of the page, and of its header and fields.
STYLES = ("page.css", "workshop/workshop.css")


class Page:
    """One tab of the browser: its history, its newest answer, and the panels that show each answer."""

    def __init__(self, first: State) -> None:
        self.first = first
        self.session = Session(first)
        self.answer = Answer(0, first)
        self.number = 0
        self.listeners: list[Callable[[Answer], Listener]] = []
        self.late_listeners: list[Listener] = []
        self.tab_listeners: list[Callable[[str], None]] = []
        self.messages: list[ui.notification] = []
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
        """Call `show` with every new answer and the data that `prepare` computes from it in a thread."""
        self.listeners.append(partial(prepared, prepare, show))

    def listen_late(self, callback: Callable[[Answer], None]) -> None:
        """Call a function with the current answer when its tolerance band from random draws is known."""
        self.late_listeners.append(callback)

    def listen_tab(self, callback: Callable[[str], None]) -> None:
        """Call a function with the name of each tab that the user opens."""
        self.tab_listeners.append(callback)

    def complete(self) -> None:
        """Show the results that arrived after the current answer was shown."""
        self._tell(self.late_listeners, self.answer)

    def open_tab(self, name: str) -> None:
        """Tell the panels that a tab was opened."""
        self._tell(self.tab_listeners, name)

    def listen_warnings(self, callback: Callable[[Mapping[str, list[str]]], None]) -> None:
        """Call a function with the warnings of an answer, by part of the page, when they are known."""
        self.warning_listeners.append(callback)

    def warn(self, places: Mapping[str, list[str]]) -> None:
        """Show the warnings of the current answer."""
        self._tell(self.warning_listeners, places)

    def edit(self, text: str, *, released: bool = True) -> int:
        """Answer a new text of the specification; return the number of the request.

        If `released`, the text becomes a step of the history. Otherwise the user is still dragging and the
        answer is a draft. If no newer edit follows soon, the answer of the full search replaces the draft.
        """
        return self._ask(replace(self.state, text=as_own(text)), released)

    def change(self, **members: Any) -> int:
        """Answer the state with some members replaced; return the number of the request."""
        return self._ask(replace(self.state, **members), True)

    def look(self, **members: Any) -> int:
        """Answer the state with new display settings, without a step of the history; return the number."""
        self.session.replace(replace(self.state, **members))
        return self._ask(self.state, True)

    async def make(self, change: Callable[..., str], *given: Any, released: bool = True) -> int | None:
        """Answer the text that `change(state, *given)` returns in a thread, after all earlier changes.

        Returns the number of the request, or None for a draft that a newer change replaced.
        """
        return await self.turns.take(
            lambda: change(self.state, *given), partial(self.edit, released=released), draft=not released
        )

    async def choose_kind(self, kind: str) -> int | None:
        """Answer a target of another kind that is close to the current law; return the number of the request.

        Returns None, and changes nothing, if another change is requested meanwhile.
        """
        return await self.turns.aside(lambda: with_kind(self.state, self.answer.design, kind), self.edit)

    async def alter(self, **members: Any) -> int | None:
        """Answer the state with some members replaced, after earlier changes; return the number."""
        return await self.turns.take(nothing, lambda _: self.change(**members))

    async def undo(self) -> None:
        """Go back to the state before the current one."""
        await self.turns.take(nothing, lambda _: self._moved(self.session.undo))

    def stop(self) -> None:
        """End the computations of the page, and go back to the last state whose answer is shown."""
        self.turns.asked += 1
        while not self.state.designs_the_same(self.answer.state) and self.session.undo():
            pass
        self._ask(self.state, True)

    async def redo(self) -> None:
        """Go forward to the state that was undone last."""
        await self.turns.take(nothing, lambda _: self._moved(self.session.redo))

    async def in_thread(self, function: Callable[..., Result], *given: Any) -> Result:
        """Call a function in a thread, outside the event loop; return its value."""
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
        if self.answer.current:
            for message in self.messages:
                message.dismiss()
            self.messages.clear()
        self._tell(listeners, self.answer)

    def _failed(self, request: Request, error: Exception) -> None:
        """Show a program error together with the last surface that was found."""
        number, state, _ = request
        failed = Answer(number, state, None, self.answer.design, {"": in_words(error)}, failed=True)
        self._show(self._prepared(failed))

    def not_shown(self, request: object, error: Exception) -> None:
        """Show an error that prevented a part of the page from showing an answer."""
        self.say(in_words(error))

    def _tell(self, listeners: Iterable[Callable[[Told], None]], value: Told) -> None:
        """Call listeners with a value, and show the errors that they raised."""
        failures = all_told(listeners, value)
        if failures:
            self.say(failures)

    def wrong(self, error: Exception) -> None:
        """Show a program error that an event handler or a timer raised; the error is already logged."""
        self.say(in_words(error))

    async def told(self, change: Awaitable[object]) -> None:
        """Make a change, or show why it is impossible."""
        try:
            await change
        except InvalidInput as error:
            self.say(str(error))

    def say(self, words: str) -> None:
        """Show a message over the page, until it is closed or a later answer has a design."""
        with self.client:
            self.messages.append(
                ui.notification(on_page(words), multi_line=True, close_button="Close", timeout=None)
            )

    async def open_link(self, link: str) -> None:
        """Show the state in a link as a new step of the history."""
        await self.told(self.turns.take(partial(from_link, link), lambda state: self._ask(state, True)))

    async def _restored(self, kept: Any) -> None:
        """Show the state from the history in the browser or from the address, otherwise the first state."""
        await self.turns.take(partial(restored, kept, self.session), self._begin)

    def _begin(self, found: tuple[Session, str]) -> None:
        self.session, problem = found
        if problem:
            self.say(problem)
        self._ask(self.state, True)


def nothing() -> None:
    """Compute nothing, for changes that need no computation."""


def patience(running: Request, waiting: Request) -> float:
    """Return how long a computation may run while a newer request waits [s].

    A full search ends at once when a draft for another state waits, because the drag has gone on. It is
    finished when the waiting request is for the same state, because the handle was released there.
    """
    if running[2]:
        return PATIENCE_WITH_DRAFTS if waiting[2] else PATIENCE
    if running[1].designs_the_same(waiting[1]):
        return math.inf
    return 0.0 if waiting[2] else PATIENCE


def whole_of(request: Request) -> Request | None:
    """Return the request for the full search that follows a draft when the pointer rests; otherwise None."""
    number, state, draft = request
    return (number, state, False) if draft else None


def build(first: State) -> Page:
    """Create the elements of a page that begins with a state; return the page."""
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
    Tour()
    return page


def _part(name: str, label: str) -> Element:
    """Return a section of the page that can receive the keyboard focus from a skip link."""
    return ui.element("section").classes(name).props(f'aria-label="{label}" tabindex=-1')


def _tabs(page: Page) -> None:
    panels = {
        "Workshop": workshop_panel,
        "Specification": editor_panel,
        "How sure": certainty_panel,
        "Take it": take_panel,
        COMPARED: comparison_panel,
    }
    with ui.tabs().props(
        'dense no-caps align=left outside-arrows mobile-arrows aria-label="Workshop and results"'
    ) as tabs:
        made = {name: ui.tab(name).props(f'data-tour="{name}"') for name in panels}

    def compare(answer: Answer) -> None:
        made[COMPARED].set_visibility(answer.state.pinned != "")

    compare(page.answer)
    page.listen(compare)
    tabs.on_value_change(lambda event: page.open_tab(event.value))
    with ui.tab_panels(tabs, value="Workshop", animated=False).props("keep-alive").classes("panels"):
        for name, make in panels.items():
            with ui.tab_panel(name):
                partial(make, page)()
