"""Callback when a kernel is compiled, which takes seconds once per installation."""

from __future__ import annotations

from collections.abc import Callable

from numba.core import event


class _Once(event.Listener):
    """Call back at the first compilation of the process."""

    def __init__(self, callback: Callable[[], None]) -> None:
        self.callback: Callable[[], None] | None = callback

    def on_start(self, event: event.Event) -> None:
        """Call back at the first compilation only."""
        if self.callback is not None:
            self.callback()
            self.callback = None

    def on_end(self, event: event.Event) -> None:
        """Do nothing at the end of a compilation."""


def on_first_compilation(callback: Callable[[], None]) -> None:
    """Call `callback` when a kernel is compiled because no cached one was found."""
    event.register("numba:compile", _Once(callback))
