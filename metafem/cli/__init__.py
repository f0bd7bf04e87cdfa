"""The command metafem: it parses options, calls the package and prints the results."""

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

__all__ = ["main", "run"]

# Time after Ctrl-C in which a command can remove what it has begun to write [s].
LEAVE = 0.5


def run() -> None:
    """Run the metafem command; Ctrl-C and SIGTERM end it with the exit codes 130 and 143.

    BLAS uses one thread by default, because the dense systems of a design are small. More threads only wait
    for each other, which takes up to ten times as long on a busy machine, and the last digit of a result can
    depend on their number. OPENBLAS_NUM_THREADS sets another number.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # numpy's import reads this variable
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # files that are being written are removed
    try:
        with _ending_soon():
            from metafem.cli.group import main

            main(prog_name="metafem")
    except KeyboardInterrupt:
        sys.exit(130)


@contextmanager
def _ending_soon() -> Iterator[None]:
    """End the process soon after Ctrl-C in the body, also within a factorisation, which takes seconds.

    Python raises KeyboardInterrupt only when such a call of a library returns.
    """
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    before, ended = signal.set_wakeup_fd(writing), threading.Event()

    def watch() -> None:
        while (number := os.read(reading, 1)) and number[0] != signal.SIGINT:
            pass
        if number and not ended.wait(LEAVE):
            os.write(2, b"stopped\n")
            os._exit(130)

    if sys.argv[1:2] != ["explore"]:  # whose server ends by itself
        threading.Thread(target=watch, daemon=True).start()
    try:
        yield
    finally:
        ended.set()
        signal.set_wakeup_fd(before)
        os.close(writing)


def __getattr__(name: str) -> Any:
    """Return `main`, the group of commands, which is imported only when it is used."""
    if name != "main":
        raise AttributeError(f"module {__name__} has no attribute {name}")
    from metafem.cli.group import main

    return main
