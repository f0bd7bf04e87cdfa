"""The changes of a page: they are computed in threads and applied in order."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeVar

from metafem.explorer.newest import Dropped
from metafem.progress import listening

Result = TypeVar("Result")
Used = TypeVar("Used")


class Turns:
    """Computes changes in threads and applies them in the event loop, in the order of the requests.

    `busy` is called with True when the first change begins and with False when no change remains. Drafts do
    not count.
    """

    def __init__(self, busy: Callable[[bool], None] = lambda busy: None) -> None:
        self.busy = busy
        self.asked = 0
        self.under_way = 0
        self.turn = asyncio.Lock()

    async def take(
        self, compute: Callable[[], Result], use: Callable[[Result], Used], *, draft: bool = False
    ) -> Used | None:
        """Compute a change after all earlier changes are applied, and apply it; return the value of `use`.

        A draft is skipped, and None returned, if a newer change is already waiting.
        """
        number = self._ask()
        with self._counted(draft):
            async with self.turn:
                if draft and number < self.asked:
                    return None
                return use(await asyncio.to_thread(compute))

    async def aside(self, compute: Callable[[], Result], use: Callable[[Result], Used]) -> Used | None:
        """Compute a change without delaying later changes, and apply it; return the value of `use`.

        If another change is requested meanwhile, the computation ends at its next progress step, and None is
        returned.
        """
        number = self._ask()

        def on_step(step: str, done: float | None) -> None:
            if number < self.asked:
                raise Dropped

        def computed() -> Result:
            with listening(on_step):
                return compute()

        with self._counted():
            async with self.turn:
                pass  # wait until the earlier changes are applied
            if number < self.asked:
                return None
            try:
                result = await asyncio.to_thread(computed)
            except Dropped:
                return None
            return use(result) if number == self.asked else None

    def _ask(self) -> int:
        self.asked += 1
        return self.asked

    @contextmanager
    def _counted(self, draft: bool = False) -> Iterator[None]:
        self.under_way += not draft
        if self.under_way == 1 and not draft:
            self.busy(True)
        try:
            yield
        finally:
            self.under_way -= not draft
            if self.under_way == 0 and not draft:
                self.busy(False)
