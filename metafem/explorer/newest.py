"""Requests that are answered one at a time; of the waiting requests, only the newest one is answered."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable, Iterable
from typing import Generic, TypeVar

from metafem.progress import listening

# Time after which a computation is dropped if a newer request waits [s]. Quicker computations are finished,
# so that the page follows a steady stream of requests; ten frames a second still look like motion.
PATIENCE = 0.1

# Time after which a draft is dropped if a newer draft waits [s]. A drag requests drafts faster than a large
# surface can be designed. With a shorter time, nothing would be shown until the pointer rests; with a longer
# time, a pointer at rest would wait too long for the newest draft.
PATIENCE_WITH_DRAFTS = 5.0

# Time without a newer request after which a better answer is computed [s]. A drag sends requests more often.
REST = 0.2

# Program errors are written to the terminal with their traceback.
LOG = logging.getLogger(__name__)

Request = TypeVar("Request")
Result = TypeVar("Result")


class Dropped(BaseException):
    """Raised to end a computation whose result is not needed.

    It is a BaseException, so that handlers of `Exception` do not catch it.
    """


class Newest(Generic[Request, Result]):
    """Answers requests in threads, outside the event loop.

    A new request replaces the waiting request. While a request waits, the running computation ends at its
    first progress step after `patience(running, waiting)` seconds. A program error is logged and passed to
    `failed` with its request; the next request is still answered. `step` names the current step of the
    computation. After each answer, a pause of `pause` seconds follows.

    If no newer request arrives within `REST` seconds of an answer, the request `better(request)` is answered,
    unless it is None.
    """

    def __init__(
        self,
        work: Callable[[Request], Result],
        done: Callable[[Result], None],
        failed: Callable[[Request, Exception], None],
        *,
        pause: float = 0.0,
        patience: Callable[[Request, Request], float] = lambda running, waiting: PATIENCE,
        better: Callable[[Request], Request | None] = lambda request: None,
    ) -> None:
        self.work, self.done, self.failed, self.pause = work, done, failed, pause
        self.patience, self.better = patience, better
        self.waiting: Request | None = None
        self.asked = asyncio.Event()
        self.running = False
        self.step = ""

    def put(self, request: Request) -> None:
        """Request an answer; `done` is called with it unless a newer request replaces this request."""
        self.waiting = request
        self.asked.set()
        if not self.running:
            self.running = True
            self.task = asyncio.get_running_loop().create_task(self._run())

    async def _run(self) -> None:
        try:
            while self.waiting is not None:
                request, self.waiting = self.waiting, None
                self.step = ""
                try:
                    result = await asyncio.to_thread(self._computed, request)
                except Dropped:
                    continue
                except Exception as error:
                    LOG.exception("a request of the page was not answered")
                    self.failed(request, error)
                else:
                    self.done(result)
                    if self.waiting is None:
                        await self._rest(request)
                if self.pause:
                    await asyncio.sleep(self.pause)
        finally:
            self.running = False

    async def _rest(self, request: Request) -> None:
        """Wait for a newer request; if none arrives within `REST`, queue the better request."""
        better = self.better(request)
        if better is None:
            return
        self.asked.clear()
        try:
            await asyncio.wait_for(self.asked.wait(), REST)
        except TimeoutError:
            self.waiting = better if self.waiting is None else self.waiting

    def _computed(self, request: Request) -> Result:
        start = time.monotonic()

        def on_step(step: str, done: float | None) -> None:
            self.step = step
            waiting = self.waiting
            if waiting is not None and time.monotonic() - start > self.patience(request, waiting):
                raise Dropped

        with listening(on_step):
            return self.work(request)


def all_told(listeners: Iterable[Callable[[Result], None]], value: Result) -> str:
    """Call functions with a value; return the errors of the failed functions in words, "" if none failed.

    An error is logged, and the remaining functions are still called.
    """
    failures: list[str] = []
    for listener in listeners:
        try:
            listener(value)
        except Exception as error:
            LOG.exception("a part of the page was not shown")
            failures.append(in_words(error))
    return " ".join(failures)


def prepared(
    prepare: Callable[[Request], Result], show: Callable[[Request, Result], None], value: Request
) -> Callable[[Request], None]:
    """Prepare data from a value; return a listener that shows the data, or raises the error of `prepare`."""
    try:
        result = prepare(value)
    except Exception as error:
        failure = error

        def fail(value: Request) -> None:
            raise failure

        return fail
    return lambda value: show(value, result)


def in_words(error: Exception) -> str:
    """Return a program error as a text for the page."""
    return (
        f"This is an error of the program, not of your input: {type(error).__name__}: {error}. The terminal "
        "of metafem explore shows where it happened. Undo leads back."
    )
