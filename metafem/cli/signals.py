"""Stopping of commands by signals."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

# Delay before a signal is repeated if Python dropped its exception [s]; no destructor runs longer.
AGAIN = 0.01


class Stopped(SystemExit):
    """Exception that ends a command after a signal; the exit code is 128 plus the number of the signal."""

    def __init__(self, number: int) -> None:
        super().__init__(128 + number)
        self.number = number


@contextmanager
def stopped_by_signals(last: bool = False) -> Iterator[None]:
    """On Ctrl-C or SIGTERM, end the body by an exception, so that it cleans up; the exit code is 130 or 143.

    If the parent process ignores a signal, this process ignores it too. In other threads this context has no
    effect, because Python delivers signals only to the main thread. Python drops an exception that is raised
    in a destructor or in the callback of a weak reference; the signal is then repeated. `last` states that
    the process does no more work after the body: a later signal ends it with the exit code of the body.
    """
    code = 1  # exit code after an exception other than SystemExit
    before, hook, again = {}, sys.unraisablehook, list[threading.Timer]()
    if threading.current_thread() is threading.main_thread():
        for each in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(each) not in (signal.SIG_IGN, None):
                before[each] = signal.signal(each, _stop)

        def lost(dropped: sys.UnraisableHookArgs) -> None:
            if not isinstance(dropped.exc_value, Stopped):
                hook(dropped)
                return
            # only a signal to the main thread itself interrupts a wait of the main thread
            main = threading.main_thread().ident
            again.append(threading.Timer(AGAIN, signal.pthread_kill, (main, dropped.exc_value.number)))
            again[-1].daemon = True
            again[-1].start()

        sys.unraisablehook = lost
    try:
        yield
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else int(end.code is not None)
        raise
    finally:
        for each, handler in before.items():
            signal.signal(each, (lambda *_: os._exit(code)) if last else handler)
        sys.unraisablehook = hook
        for timer in again:
            timer.cancel()


@contextmanager
def report_stop(left: str) -> Iterator[None]:
    """If a signal stops the body, print a line on stderr; `left` states what the body left behind."""
    try:
        yield
    except Stopped as stop:
        with suppress(OSError):
            print(f"stopped; {left}", file=sys.stderr, flush=True)
        raise SystemExit(stop.code) from None


def _stop(number: int, _: FrameType | None) -> None:
    raise Stopped(number)
