"""Parts of the page that show the answers at their own pace."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from metafem.explorer.answer import Answer
from metafem.explorer.newest import Newest

if TYPE_CHECKING:
    from metafem.explorer.page import Page

Data = TypeVar("Data")


class Follower(Generic[Data]):
    """Shows at most one answer in `pace` seconds while a point is dragged, and always the last answer.

    `prepare` is called in a thread, and `show` with its result in the event loop. Nothing is shown while
    `seen()` is False. If a change was made through this follower, answers to older requests are not shown,
    because the browser already shows the change.
    """

    def __init__(
        self,
        page: Page,
        pace: float,
        prepare: Callable[[Answer], Data],
        show: Callable[[Data], None],
        seen: Callable[[], bool] = lambda: True,
    ) -> None:
        self.page, self.shown, self.seen = page, show, seen
        self.asked = self.changes = 0
        self.held: Answer | None = None
        self.newest: Newest[Answer, tuple[Answer, Data]] = Newest(
            lambda answer: (answer, prepare(answer)), self._show, page.not_shown, pause=pace
        )
        page.listen(self.put)

    def put(self, answer: Answer) -> None:
        """Show an answer, unless a newer answer arrives first."""
        if self.changes:
            self.held = answer  # until the change is made or replaced
        elif self._wanted(answer):
            self.newest.put(answer)

    async def change(self, change: Coroutine[Any, Any, int | None]) -> int | None:
        """Make a change of the page; return its request number, or None if a newer change replaced it."""
        self.changes += 1
        try:
            number = await change
            self.held = self.page.answer if number is None else self.held
            self.asked = number or self.asked
        finally:
            self.changes -= 1
            held, self.held = self.held, None
            if held is not None:
                self.put(held)
        return number

    def _wanted(self, answer: Answer) -> bool:
        return not self.changes and answer.number >= self.asked and self.seen()

    def _show(self, prepared: tuple[Answer, Data]) -> None:
        answer, data = prepared
        if self._wanted(answer):
            self.shown(data)
