"""The queue of a page: changes are made in order, the newest request is answered, and rest computes fully."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable
from typing import Generic, TypeVar

from metafem.progress import listening

# Time after which a computation is dropped if a newer request waits [s]. Quicker computations are finished,
# so that the page follows a steady stream of requests; ten frames a second still look like motion.
PATIENCE = 0.1

# Time without a newer request after which a better answer is computed [s]. A drag sends requests more often.
REST = 0.2

# Program errors are written to the terminal with their traceback.
LOG = logging.getLogger(__name__)

Request = TypeVar("Request")
Result = TypeVar("Result")
Made = TypeVar("Made")


class Dropped(BaseException):
    """Raised to end a computation whose result is not needed.

    It is a BaseException, so that handlers of `Exception` do not catch it.
    """


class Queue(Generic[Request, Result]):
    """Makes changes in their order and answers the newest request, in threads outside the event loop.

    A new request replaces the waiting request. While a request waits, the running computation ends at its
    first progress step after `patience(running, waiting)` seconds. A program error is logged and passed to
    `failed` with its request; the next request is still answered. `step` names the current step of the
    computation. If no newer request arrives within `pause` seconds of an answer, `better(request)` is
    answered, unless it is None.

    Changes are numbered: `asked` is the number of the last change, `made` that of the last one that ended,
    and `ended` that of the last one before `stop`.
    """

    def __init__(
        self,
        work: Callable[[Request], Result],
        done: Callable[[Result], object],
        failed: Callable[[Request, Exception], None],
        *,
        patience: Callable[[Request, Request], float] = lambda running, waiting: PATIENCE,
        better: Callable[[Request], Request | None] = lambda request: None,
    ) -> None:
        self.work, self.done, self.failed = work, done, failed
        self.patience, self.better, self.pause = patience, better, REST
        self.waiting: Request | None = None
        self.task: asyncio.Task[None] | None = None
        self.rest: asyncio.TimerHandle | None = None
        self.step = ""
        self.asked = self.made = self.ended = 0
        self.turn = asyncio.Lock()

    @property
    def running(self) -> bool:
        """Whether a request is being answered."""
        return self.task is not None and not self.task.done()

    def put(self, request: Request) -> None:
        """Request an answer; `done` is called with it unless a newer request replaces this request."""
        if self.rest is not None:
            self.rest.cancel()
        self.waiting = request
        if not self.running:
            self.task = asyncio.get_running_loop().create_task(self._run())

    def stop(self) -> None:
        """Drop the running computation and the changes that are not made yet.

        A computation ends at its next progress step, which can take seconds; newer requests do not wait.
        """
        self.ended = self.asked
        if self.task is not None:
            self.task.cancel()
            self.task = None

    async def change(
        self, make: Callable[[], Made], use: Callable[[int, Made], None], *, replaceable: bool = False
    ) -> int | None:
        """Compute a change after all earlier changes; call `use` with its number and result.

        Return the number. A replaceable change is skipped, or ends at its next progress step, if a newer
        change waits; then the result is None.
        """
        self.asked += 1
        number = self.asked

        def on_step(step: str = "", done: float | None = None) -> None:
            if number <= self.ended or (replaceable and number < self.asked):
                raise Dropped

        async with self.turn:
            try:
                on_step()
                use(number, await asyncio.to_thread(_heard, on_step, make))
            except Dropped:
                return None
            finally:
                self.made = number
        return number

    async def _run(self) -> None:
        while self.waiting is not None:
            request, self.waiting, self.step = self.waiting, None, ""
            try:
                result = await asyncio.to_thread(self._computed, request)
            except Dropped:
                continue
            except Exception as error:
                LOG.exception("a request of the page was not answered")
                self.failed(request, error)
                continue
            self.done(result)
            better = self.better(request)
            if better is not None and self.waiting is None:
                self.rest = asyncio.get_running_loop().call_later(self.pause, self.put, better)

    def _computed(self, request: Request) -> Result:
        start, ended = time.monotonic(), self.ended

        def on_step(step: str, done: float | None) -> None:
            if self.ended > ended:
                raise Dropped
            self.step = step
            waiting = self.waiting
            if waiting is not None and time.monotonic() - start > self.patience(request, waiting):
                raise Dropped

        return _heard(on_step, lambda: self.work(request))


def _heard(on_step: Callable[[str, float | None], None], function: Callable[[], Made]) -> Made:
    with listening(on_step):
        return function()


def in_words(error: Exception) -> str:
    """Return a program error as a text for the page."""
    return (
        f"This is an error of the program, not of your input: {type(error).__name__}: {error}. The terminal "
        "of metafem explore shows where it happened. Undo leads back."
    )
