"""Commands that are stopped by signals."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import FrameType

# Seconds after which a signal is repeated if its exception was lost; no destructor runs longer.
AGAIN = 0.01


class Stopped(SystemExit):
    """The end of a command by a signal; its exit code is 128 plus the number of the signal."""

    def __init__(self, number: int) -> None:
        super().__init__(128 + number)
        self.number = number


@contextmanager
def stopped_by_signals(last: bool = False) -> Iterator[None]:
    """End the body by an exception on Ctrl-C and SIGTERM, so that it cleans up; the exit code is 130 or 143.

    A signal that the parent process set to be ignored stays ignored. Python delivers signals to the main
    thread only, so other threads do not change. Python drops an exception that is raised in a destructor or
    in the callback of a weak reference; the signal is then repeated. When the last body of a process ends,
    its work is complete: a later signal ends the process with the exit code of the body.
    """
    code = 1  # of an exception other than SystemExit
    before, hook, again = {}, sys.unraisablehook, list[threading.Timer]()
    if threading.current_thread() is threading.main_thread():
        for each in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(each) not in (signal.SIG_IGN, None):
                before[each] = signal.signal(each, _stop)

        def lost(dropped: sys.UnraisableHookArgs) -> None:
            if not isinstance(dropped.exc_value, Stopped):
                hook(dropped)
                return
            # to the main thread: a signal to another thread does not interrupt a wait of the main thread
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
    """Print a line on stderr if a signal stops the body: what it left behind."""
    try:
        yield
    except Stopped as stop:
        with suppress(OSError):
            print(f"stopped; {left}", file=sys.stderr, flush=True)
        raise SystemExit(stop.code) from None


def _stop(number: int, _: FrameType | None) -> None:
    raise Stopped(number)
