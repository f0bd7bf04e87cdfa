"""One request at a time: of those that wait, only the newest is answered."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable, Iterable
from typing import Generic, TypeVar

from metafem.progress import listening

# Seconds after which a computation ends for a newer request. Quicker ones are finished, so that what is shown
# follows a steady stream of requests; ten frames a second still look like motion.
PATIENCE = 0.1

# Seconds that a draft has while newer drafts are asked for. A drag asks for them faster than a large surface
# is designed: without it nothing would be shown until the hand rests; with more, a hand at rest would wait.
PATIENCE_WITH_DRAFTS = 5.0

# Seconds without a newer request after which a better answer is computed: a hand that moves asks more often.
REST = 0.2

# Errors of the program are written to the terminal, with the place where they happened.
LOG = logging.getLogger(__name__)

Request = TypeVar("Request")
Result = TypeVar("Result")


class Dropped(BaseException):
    """The end of a computation whose result nobody waits for; no handler of errors catches it."""


class Newest(Generic[Request, Result]):
    """Answers requests off the event loop, in threads.

    A request that arrives while another is computed replaces the one that waits, and ends the running one at
    its next step of progress, when that has had the seconds of `patience(running, waiting)`. An error of the
    program is logged and handed to `failed` with its request; the next request is answered all the same.
    `step` is what is computed at the moment, in words. Between two answers it rests for `pause` seconds.

    Where no newer request follows an answer for a moment, that to `better(request)` is computed, unless this
    is None.
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
        """Ask for an answer, with which `done` is called unless a newer request replaces it."""
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
        """Wait for a newer request; where none comes in time, the better one takes its place."""
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
    """Call functions with a value; return the errors of those that failed, in words, "" for none.

    One that fails is logged, and the others are called all the same.
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
    """Return a listener that shows what is prepared of a value; an error of the preparation is one of it."""
    try:
        result = prepare(value)
    except Exception as error:
        failure = error

        def fail(value: Request) -> None:
            raise failure

        return fail
    return lambda value: show(value, result)


def in_words(error: Exception) -> str:
    """Return an error of the program as a sentence of the page."""
    return (
        f"This is an error of the program, not of your input: {type(error).__name__}: {error}. The terminal "
        "of metafem explore shows where it happened. Undo leads back."
    )
