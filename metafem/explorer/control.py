"""What a page can do: its state and newest answer, the changes of both, and the panels that show them."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Awaitable, Callable, Iterable, Mapping, MutableMapping
from dataclasses import replace
from functools import partial
from typing import Any
from weakref import WeakKeyDictionary

from nicegui import Client, app, json, ui
from nicegui.element import Element

from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer, answered
from metafem.explorer.history import Session, State, from_link, to_link
from metafem.explorer.queue import LOG, PATIENCE, Queue, in_words
from metafem.explorer.table import Table
from metafem.files import DEMOS, demo_text

# Calls that are not sent yet, by the page.
CALLS: WeakKeyDictionary[Client, list[str]] = WeakKeyDictionary()


# What an element is given, and what takes the argument of one of its events.
Props = Mapping[str, Any]
Handler = Callable[[Any], Any]

# What shows an answer in a panel, with the data that were prepared for it.
Show = Callable[[], object]

# Time after which a draft is dropped if a newer draft waits [s]. A drag requests drafts faster than a large
# surface can be designed. With a shorter time, nothing would be shown until the pointer rests; with a longer
# time, a pointer at rest would wait too long for the newest draft.
PATIENCE_WITH_DRAFTS = 5.0

# Texts whose comments are not the user's.
DEMO_TEXTS = {demo_text(name) for name in DEMOS}

# Said once, when an edit by hand ends the comments that the user wrote.
COMMENTS_END = "The comments in your specification end with this first edit by hand. Undo brings them back."

# Returns the link in the address, and reports each other link that is pasted there.
LINKED = "(addEventListener('hashchange', () => emitEvent('linked', location.hash)), location.hash)"

# Time within which a browser that is busy with the first page answers [s].
BUSY = 60.0


class Panel(Element):
    """A part of the page, which shows every answer; each keyword argument handles an event of its element.

    Attributes
    ----------
    pace : float
        Of the drafts that arrive within this time, only the first is shown [s]. A full answer follows.
    asked : int
        Number of the last change that this panel has shown already; older answers are not shown.
    sent : dict
        The data that `send` has sent last.
    """

    pace = 0.0

    def __init__(self, page: Control, props: Props | None = None, /, **handlers: Handler) -> None:
        super().__init__()
        self.page, self.asked, self.due, self.sent = page, 0, 0.0, dict[str, Any]()
        self._props.update(props or {})
        for name, handler in handlers.items():
            self.on(name, lambda event, handler=handler: handler(event.args))
        page.panels.append(self)

    def prepare(self, answer: Answer) -> Any:
        """Return the data that `show` needs; this method is called in a thread."""

    def show(self, answer: Answer, data: Any) -> None:
        """Show an answer with its data."""

    def opened(self) -> None:
        """Make what only an open tab needs; called each time that the tab of the panel is opened."""

    def send(self, data: Mapping[str, Any]) -> None:
        """Call the method ``show`` of the element in the browser with the data that have changed."""
        new = {
            name: value for name, value in data.items() if name not in self.sent or self.sent[name] != value
        }
        self.sent |= new
        if new:
            self.call("show", new)

    def call(self, method: str, *given: Any) -> None:
        """Call a method of the element in the browser.

        The calls of one step of the event loop are one message, so that the browser shows them in one frame.
        """
        if self.is_deleted:  # the page was closed
            return
        calls = CALLS.setdefault(self.client, [])
        if not calls:
            asyncio.get_running_loop().call_soon(self._call)
        # the browser parses a statement once, but the thousands of numbers in a `run_method` call twice
        calls.append(f"queueMicrotask(() => runMethod({self.id}, {method!r}, {json.dumps(given)}))")

    def _call(self) -> None:
        calls = CALLS.pop(self.client)
        if not self.is_deleted:
            self.client.run_javascript(";".join(calls))


class Control:
    """One tab of the browser: its history, its newest answer, and the panels that show each answer."""

    def __init__(self, first: State) -> None:
        self.first = first
        self.session = Session((first,))
        self.answer = Answer(0, first)
        self.number = 0  # of the last request
        self.panels: list[Panel] = []
        # what shows the warnings by part of the page, when they are known
        self.warners: list[Callable[[Mapping[str, list[str]]], None]] = []
        # messages over the page, each with the number of the last change before it
        self.messages: list[tuple[int, ui.notification]] = []
        self.comments_ended = False
        self.queue: Queue[Answer, tuple[Answer, list[Show]]] = Queue(
            self._work, self._show, self._failed, patience=patience, better=whole_of
        )
        self.kept: MutableMapping[str, Any] = {}  # what NiceGUI keeps of the tab as long as the server runs
        self.client = ui.context.client
        self.client.on_connect(self._begin)
        ui.on("linked", lambda event: self.open_link(event.args))
        self.client.on_delete(self.queue.stop)
        self.client.on_exception(self.wrong)

    @property
    def state(self) -> State:
        """The state that is shown."""
        return self.session.state

    @property
    def asked(self) -> int:
        """Number of the last change."""
        return self.queue.asked

    @property
    def running(self) -> tuple[int, int]:
        """Numbers of the change that is made and of the request that is answered, each 0 without one."""
        change, request = self.queue.asked, self.number
        return change * (change > self.queue.made), request * (request > self.answer.number)

    async def renew(self, *panels: Panel) -> None:
        """Show the newest answer once more in panels that look different; default: in all."""
        chosen, answer = panels or tuple(self.panels), None
        while answer is not self.answer:
            answer = self.answer
            shows = await asyncio.to_thread(self._shows, chosen, answer)
        self._tell(shows)

    async def change(
        self,
        change: Callable[[Session], Session],
        *,
        by: Panel | None = None,
        draft: bool = False,
        replaceable: bool = False,
        stopped: bool = False,
    ) -> int | None:
        """Make a change of the history in a thread, after all earlier changes, and answer its state.

        Return the number of the change. If `draft`, the user is still dragging: the answer is a draft, and
        the history stays as it is. If no newer change follows soon, the answer of the full search replaces
        the draft. A draft, or a replaceable change, is dropped and None returned if a newer change waits. If
        `stopped`, nothing is computed. The panel `by` shows the change already.
        """
        number = self.asked + 1

        def make() -> tuple[Session, str]:
            session = change(self.session)
            return session, "" if draft else to_link(session.state)

        def use(number: int, made: tuple[Session, str]) -> None:
            session, link = made
            if not draft:
                self.session = self.kept["session"] = session
                address = f"'#{link}'" if link else "location.pathname"
                self.client.run_javascript(f"history.replaceState(null, '', {address})")
            self._ask(number, session.state, draft, stopped)

        if by is not None:
            by.asked = number
        if not draft:
            self.client.run_javascript(f"document.body.dataset.asked = {number}")  # for tests
        try:
            return await self.queue.change(make, use, replaceable=draft or replaceable)
        except Exception:
            if draft:
                await self.renew()
            else:
                self._ask(number, self.state)
            raise

    async def step(self, change: Callable[[State], State], **how: Any) -> int | None:
        """Answer the state that `change(state)` returns, as a step of the history; `how` as in `change`."""
        return await self.change(lambda session: session.after(change(session.state)), **how)

    async def make(self, change: Callable[[State], Table], *, draft: bool = False, **how: Any) -> int | None:
        """Answer the state with the table that `change(state)` returns; `how` as in `change`."""
        lost = False

        def edited(state: State) -> State:
            nonlocal lost
            new = state.edited(change(state))
            lost = "#" in state.text and "#" not in new.text and state.text not in DEMO_TEXTS
            return new

        number = await self.step(edited, draft=draft, **how)
        if lost and number is not None and not (draft or self.comments_ended):
            self.comments_ended = True
            self.say(COMMENTS_END, passing=False)
        return number

    async def alter(self, by: Panel | None = None, **members: Any) -> int | None:
        """Answer the state with some members replaced; return the number of the change."""
        return await self.step(lambda state: replace(state, **members), by=by)

    async def moved(self, steps: int) -> None:
        """Undo (-1) or redo (1) a step of the history, or answer the state anew (0)."""
        await self.change(lambda session: session.moved(steps))

    async def stop(self) -> None:
        """End the computations of the page, and undo a step whose answer is not shown."""
        self.queue.stop()
        shown = self.answer.state

        def back(session: Session) -> Session:
            return session.moved(0 if session.state.designs_the_same(shown) else -1)

        await self.change(back, stopped=True)

    def _ask(self, number: int, state: State, draft: bool = False, stopped: bool = False) -> None:
        self.number = number
        self.queue.put(Answer(number, state, draft=draft, stopped=stopped))

    def _work(self, asked: Answer) -> tuple[Answer, list[Show]]:
        answer = answered(asked.state, asked.number, self.answer, asked.draft, asked.stopped)
        return answer, self._shows(self.panels, answer)

    def _shows(self, panels: Iterable[Panel], answer: Answer) -> list[Show]:
        return [self._prepared(panel, answer) for panel in panels]

    def _prepared(self, panel: Panel, answer: Answer) -> Show:
        if answer.draft and time.monotonic() < panel.due:
            return lambda: None
        panel.due = time.monotonic() + panel.pace
        try:
            data = panel.prepare(answer)
        except Exception as error:
            LOG.exception("a part of the page was not shown")
            return partial(self.wrong, error)
        return lambda: panel.show(answer, data) if answer.number >= panel.asked else None

    def _show(self, found: tuple[Answer, list[Show]]) -> None:
        self.answer, shows = found
        if self.answer.current:
            for asked, message in self.messages:
                if asked < self.answer.number:
                    message.dismiss()
            self.messages = [each for each in self.messages if each[0] >= self.answer.number]
        self._tell(shows)

    def _failed(self, asked: Answer, error: Exception) -> None:
        """Show a program error together with the last surface that was found."""
        problems = {"": in_words(error)}
        failed = Answer(asked.number, asked.state, None, self.answer.design, problems, failed=True)
        self._show((failed, self._shows(self.panels, failed)))

    def wrong(self, error: Exception) -> None:
        """Show a program error; the error is already logged."""
        self.say(in_words(error))

    def warn(self, places: Mapping[str, list[str]]) -> None:
        """Show the warnings of the current answer by part of the page."""
        self._tell(partial(warner, places) for warner in self.warners)

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
            message = ui.notification(words, multi_line=True, close_button="Close", timeout=None)
        if passing:
            self.messages.append((self.asked, message))

    async def open_link(self, link: str) -> None:
        """Show the state in a link as a new step of the history."""
        await self.told(self.step(lambda state: from_link(link)))

    async def _begin(self) -> None:
        """Show the history of the tab, with the state in the address, otherwise the first state."""
        if self.number:
            return  # connected again
        self.kept = app.storage.tab
        link = await self.client.run_javascript(LINKED, timeout=BUSY)
        problem = ""

        def begun(session: Session) -> Session:
            nonlocal problem
            session = self.kept.get("session", session)
            try:
                same = link.strip("#") in ("", to_link(session.state))
                return session if same else session.after(from_link(link))
            except InvalidInput as error:
                problem = str(error)
                return session

        await self.change(begun)
        if problem:
            self.say(problem)


def patience(running: Answer, waiting: Answer) -> float:
    """Return how long a computation may run while a newer request waits [s].

    A full search ends at once when a draft for another state waits, because the drag has gone on. It is
    finished when the waiting request is for the same state, because the handle was released there.
    """
    if running.draft:
        return PATIENCE_WITH_DRAFTS if waiting.draft else PATIENCE
    if running.state.designs_the_same(waiting.state):
        return math.inf
    return 0.0 if waiting.draft else PATIENCE


def whole_of(asked: Answer) -> Answer | None:
    """Return the request for the full search that follows a draft when the pointer rests; otherwise None."""
    return replace(asked, draft=False) if asked.draft else None
