"""The page: what it shows, and how it answers an edit."""

from __future__ import annotations

import math
import time
from collections.abc import Awaitable, Callable, Iterable, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from nicegui import ui
from nicegui.element import Element

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, answered
from metafem.explorer.browser import Browser, record_of
from metafem.explorer.certainty.background import Tasks
from metafem.explorer.certainty.panel import certainty_panel, place_warnings
from metafem.explorer.law.comparison import COMPARED, comparison_panel
from metafem.explorer.law.panel import LawPanel
from metafem.explorer.queue import LOG, PATIENCE, Queue, in_words
from metafem.explorer.session import Session, State
from metafem.explorer.surface.panel import SurfacePanel
from metafem.explorer.take.panel import take_panel
from metafem.explorer.text.document import loses_comments
from metafem.explorer.text.kinds import with_kind
from metafem.explorer.text.link import from_link, restored
from metafem.explorer.text.names import on_page
from metafem.explorer.workshop.editor import editor_panel
from metafem.explorer.workshop.header import header_panel
from metafem.explorer.workshop.panel import workshop_panel

Result = TypeVar("Result")

# What shows an answer, with the data that were prepared for it.
Show = Callable[[], object]

# Time after which a draft is dropped if a newer draft waits [s]. A drag requests drafts faster than a large
# surface can be designed. With a shorter time, nothing would be shown until the pointer rests; with a longer
# time, a pointer at rest would wait too long for the newest draft.
PATIENCE_WITH_DRAFTS = 5.0

# Said once, when an edit by hand ends the comments that the user wrote.
COMMENTS_END = "The comments in your specification end with this first edit by hand. Undo brings them back."

# Style sheets of the page and its parts.
STYLES = (
    "page.css", "workshop/workshop.css", "law/law.css", "surface/surface.css", "certainty/certainty.css",
    "take/take.css",
)  # fmt: skip


class Request(NamedTuple):
    """A state to answer, the number of the change that made it, and whether a draft is enough."""

    number: int
    state: State
    draft: bool


class Page:
    """One tab of the browser: its history, its newest answer, and the panels that show each answer."""

    def __init__(self, first: State) -> None:
        self.first = first
        self.session = Session((first,))
        self.answer = Answer(0, first)
        self.number = 0  # of the last request
        self.tabs: ui.tabs
        self.panels: list[Callable[[Answer], Show]] = []
        self.warned: list[Callable[[Mapping[str, list[str]]], object]] = []
        self.messages: list[ui.notification] = []
        self.comments_ended = False
        self.queue: Queue[Request, tuple[Answer, list[Show]]] = Queue(
            self._work, self._show, self._failed, patience=patience, better=whole_of
        )
        self.browser = Browser(self._restored, self.open_link)
        self.tasks = Tasks()
        self.client = ui.context.client
        self.client.on_delete(self.tasks.stop_all)
        self.client.on_exception(self.wrong)

    @property
    def state(self) -> State:
        """The state that is shown."""
        return self.session.state

    def listen(self, show: Callable[[Answer], None]) -> None:
        """Call a function with every new answer."""
        self.panels.append(lambda answer: partial(show, answer))

    def listen_prepared(
        self, prepare: Callable[[Answer], Result], show: Callable[[Answer, Result], None], pace: float = 0.0
    ) -> None:
        """Call `show` with every new answer and the data that `prepare` computes from it in a thread.

        Of the drafts that arrive within `pace` seconds, only the first is shown. A full answer follows.
        """
        due = 0.0

        def prepared(answer: Answer) -> Show:
            nonlocal due
            if answer.draft and time.monotonic() < due:
                return lambda: None
            due = time.monotonic() + pace
            try:
                return partial(show, answer, prepare(answer))
            except Exception as error:
                LOG.exception("a part of the page was not shown")
                return partial(self.wrong, error)

        self.panels.append(prepared)

    def listen_warnings(self, callback: Callable[[Mapping[str, list[str]]], object]) -> None:
        """Call a function with the warnings of an answer, by part of the page, when they are known."""
        self.warned.append(callback)

    def warn(self, places: Mapping[str, list[str]]) -> None:
        """Show the warnings of the current answer."""
        self._tell(partial(callback, places) for callback in self.warned)

    def again(self) -> None:
        """Show the current answer once more, because what a panel shows with it has changed."""
        if not self.queue.running:  # otherwise a newer answer follows
            self.queue.put(Request(self.number, self.answer.state, self.answer.draft))

    async def change(
        self, change: Callable[[Session], Session], *, draft: bool = False, replaceable: bool = False
    ) -> int | None:
        """Make a change of the history in a thread, after all earlier changes, and answer its state.

        Return the number of the change. If `draft`, the user is still dragging: the answer is a draft, and
        the history stays as it is. If no newer change follows soon, the answer of the full search replaces
        the draft. A draft, or a replaceable change, is dropped and None returned if a newer change waits.
        """
        number = self.queue.asked + 1

        def make() -> tuple[Session, dict[str, Any]]:
            session = change(self.session)
            return session, {} if draft else record_of(session)

        def use(number: int, made: tuple[Session, dict[str, Any]]) -> None:
            session, record = made
            if not draft:
                self.session = session
                self.browser.run_method("keep", record)
            self._ask(number, session.state, draft)

        if not draft:
            self.browser.run_method("asks", number)
        try:
            return await self.queue.change(make, use, replaceable=draft or replaceable)
        except Exception:
            if draft:
                self.again()
            else:
                self._ask(number, self.state, False)
            raise

    async def step(self, change: Callable[[State], State], **how: bool) -> int | None:
        """Answer the state that `change(state)` returns, as a step of the history; `how` as in `change`."""
        return await self.change(lambda session: session.after(change(session.state)), **how)

    async def make(self, change: Callable[[State], str], **how: bool) -> int | None:
        """Answer the state with the text that `change(state)` returns; `how` as in `change`."""
        lost = False

        def edited(state: State) -> State:
            nonlocal lost
            text = change(state)
            lost = loses_comments(state.text, text)
            return replace(state, text=text)

        number = await self.step(edited, **how)
        if lost and number is not None and not how.get("draft") and not self.comments_ended:
            self.comments_ended = True
            self.say(COMMENTS_END, passing=False)
        return number

    async def alter(self, **members: Any) -> int | None:
        """Answer the state with some members replaced; return the number of the change."""
        return await self.step(lambda state: replace(state, **members))

    async def choose_kind(self, kind: str) -> int | None:
        """Answer a target of another kind that is close to the current law; return the number of the change.

        Returns None, and changes nothing, if another change is requested meanwhile.
        """
        return await self.make(lambda state: with_kind(state, self.answer.design, kind), replaceable=True)

    async def undo(self) -> None:
        """Go back to the state before the current one."""
        await self.change(lambda session: session.moved(-1))

    async def redo(self) -> None:
        """Go forward to the state that was undone last."""
        await self.change(lambda session: session.moved(1))

    async def stop(self) -> None:
        """End the computations of the page, and go back to the last state whose answer is shown."""
        shown = self.answer.state

        def back(session: Session) -> Session:
            while session.at and not session.state.designs_the_same(shown):
                session = session.moved(-1)
            return session

        await self.change(back)

    def _ask(self, number: int, state: State, draft: bool) -> None:
        self.number = number
        self.queue.put(Request(number, state, draft))

    def _work(self, request: Request) -> tuple[Answer, list[Show]]:
        number, state, draft = request
        return self._prepared(answered(state, number, self.answer, draft))

    def _prepared(self, answer: Answer) -> tuple[Answer, list[Show]]:
        return answer, [panel(answer) for panel in self.panels]

    def _show(self, found: tuple[Answer, list[Show]]) -> None:
        before = self.answer.number
        self.answer, shows = found
        if self.answer.current and self.answer.number > before:
            for message in self.messages:
                message.dismiss()
            self.messages.clear()
        self._tell(shows)

    def _failed(self, request: Request, error: Exception) -> None:
        """Show a program error together with the last surface that was found."""
        problems = {"": in_words(error)}
        failed = Answer(request.number, request.state, None, self.answer.design, problems, failed=True)
        self._show(self._prepared(failed))

    def wrong(self, error: Exception) -> None:
        """Show a program error; the error is already logged."""
        self.say(in_words(error))

    def _tell(self, shows: Iterable[Show]) -> None:
        """Call functions; an error of one is shown, and the remaining ones are still called."""
        for show in shows:
            try:
                show()
            except Exception as error:
                LOG.exception("a part of the page was not shown")
                self.wrong(error)

    async def told(self, change: Awaitable[object], say: Callable[[str], object] | None = None) -> None:
        """Make a change, or show why it is impossible, by a message over the page or by `say`."""
        try:
            await change
        except InvalidInput as error:
            (say or self.say)(str(error))

    def say(self, words: str, passing: bool = True) -> None:
        """Show a message over the page until it is closed or, if `passing`, a later answer has a design."""
        with self.client:
            message = ui.notification(on_page(words), multi_line=True, close_button="Close", timeout=None)
        if passing:
            self.messages.append(message)

    async def open_link(self, link: str) -> None:
        """Show the state in a link as a new step of the history."""
        await self.told(self.step(lambda state: from_link(link)))

    async def _restored(self, kept: Any) -> None:
        """Show the state from the history in the browser or from the address, otherwise the first state."""
        problem = ""

        def begun(session: Session) -> Session:
            nonlocal problem
            session, problem = restored(kept, session)
            return session

        await self.change(begun)
        if problem:
            self.say(problem)


def patience(running: Request, waiting: Request) -> float:
    """Return how long a computation may run while a newer request waits [s].

    A full search ends at once when a draft for another state waits, because the drag has gone on. It is
    finished when the waiting request is for the same state, because the handle was released there.
    """
    if running.draft:
        return PATIENCE_WITH_DRAFTS if waiting.draft else PATIENCE
    if running.state.designs_the_same(waiting.state):
        return math.inf
    return 0.0 if waiting.draft else PATIENCE


def whole_of(request: Request) -> Request | None:
    """Return the request for the full search that follows a draft when the pointer rests; otherwise None."""
    return request._replace(draft=False) if request.draft else None


def build(first: State) -> Page:
    """Create the elements of a page that begins with a state; return the page."""
    for style in STYLES:
        ui.add_css(Path(__file__).parent / style)
    page = Page(first)
    header_panel(page)
    with ui.element().classes("explorer"):
        with _part("law", "Law"):
            LawPanel(page)
            place_warnings(page, "law")
        with _part("surface", "Surface"):
            SurfacePanel(page)
            place_warnings(page, "surface")
        with _part("inspector", "Inspector"):
            _tabs(page)
    return page


def _part(name: str, label: str) -> Element:
    """Return a section of the page that can receive the keyboard focus from a skip link."""
    return ui.element("section").classes(name).props(f'aria-label="{label}" tabindex=-1')


def _tabs(page: Page) -> None:
    """Create the tabs of the inspector; what a tab holds is created when it is first opened."""
    late = {
        "Workshop": workshop_panel,
        "Specification": editor_panel,
        "How sure": certainty_panel(page),
        "Take it": take_panel,
        COMPARED: comparison_panel,
    }
    with ui.tabs().props(
        'dense no-caps align=left outside-arrows mobile-arrows aria-label="Inspector"'
    ) as tabs:
        made = {name: ui.tab(name).props(f'data-tour="{name}"') for name in late}
    page.tabs = tabs

    def compare(answer: Answer) -> None:
        made[COMPARED].set_visibility(answer.state.pinned != "")

    compare(page.answer)
    page.listen(compare)
    with ui.tab_panels(tabs, value="Workshop", animated=False).props("keep-alive").classes("panels"):
        panels = {name: ui.tab_panel(name) for name in late}

    def opened(name: str) -> None:
        if name in late:
            with panels[name]:
                late.pop(name)(page)
            if page.number:  # otherwise the first answer follows
                page.again()

    opened("Workshop")
    tabs.on_value_change(lambda event: opened(event.value))
