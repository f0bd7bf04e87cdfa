"""One request at a time: of those that wait, only the newest is answered."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from typing import Generic, TypeVar

from metafem.progress import listening

# Seconds after which a computation ends for a newer request. Quicker ones are finished, so that what is shown
# follows a steady stream of requests; ten frames a second still look like motion.
PATIENCE = 0.1

Request = TypeVar("Request")
Result = TypeVar("Result")


class Dropped(BaseException):
    """The end of a computation whose result nobody waits for; no handler of errors catches it."""


class Newest(Generic[Request, Result]):
    """Answers requests off the event loop, in threads.

    A request that arrives while another is computed replaces the one that waits, and ends the running one at
    its next step of progress.
    """

    def __init__(self, work: Callable[[Request], Result], done: Callable[[Result], None]) -> None:
        self.work, self.done = work, done
        self.waiting: Request | None = None
        self.running = False

    def put(self, request: Request) -> None:
        """Ask for an answer, with which `done` is called unless a newer request replaces it."""
        self.waiting = request
        if not self.running:
            self.running = True
            self.task = asyncio.get_running_loop().create_task(self._run())

    async def _run(self) -> None:
        try:
            while self.waiting is not None:
                request, self.waiting = self.waiting, None
                try:
                    result = await asyncio.to_thread(self._computed, request)
                except Dropped:
                    continue
                self.done(result)
        finally:
            self.running = False

    def _computed(self, request: Request) -> Result:
        start = time.monotonic()

        def on_step(step: str, done: float | None) -> None:
            if self.waiting is not None and time.monotonic() - start > PATIENCE:
                raise Dropped

        with listening(on_step):
            return self.work(request)
