"""Commands that are stopped by signals."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

# Seconds after which a signal is repeated if its exception was lost; no destructor runs longer.
AGAIN = 0.01


class Stopped(SystemExit):
    """The end of a command by a signal; its exit code is 128 plus the number of the signal."""


@contextmanager
def stopped_by_signals() -> Iterator[None]:
    """End the body by an exception on Ctrl-C and SIGTERM, so that it cleans up; the exit code is 130 or 143.

    A signal that the parent process set to be ignored stays ignored. Python delivers signals to the main
    thread only, so other threads do not change. Python drops an exception that is raised in a destructor or
    in the callback of a weak reference; the signal is then repeated.
    """
    before, hook = {}, sys.unraisablehook
    if threading.current_thread() is threading.main_thread():
        for each in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(each) not in (signal.SIG_IGN, None):
                before[each] = signal.signal(each, _stop)
        sys.unraisablehook = lambda lost: None if _repeat(lost.exc_value) else hook(lost)
    try:
        yield
    finally:
        for each, handler in before.items():
            signal.signal(each, handler)
        sys.unraisablehook = hook


def _stop(number: int, frame: FrameType | None) -> None:
    raise Stopped(128 + number)


def _repeat(error: BaseException | None) -> bool:
    """Repeat the signal of an exception that was dropped."""
    if not isinstance(error, Stopped) or not isinstance(error.code, int):
        return False
    # to the main thread: a signal to another one does not end what the main thread waits for
    main = threading.main_thread().ident
    again = threading.Timer(AGAIN, signal.pthread_kill, (main, error.code - 128))
    again.daemon = True
    again.start()
    return True
