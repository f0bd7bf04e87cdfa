"""The command metafem: it parses options, calls the package and prints the results."""

import os
import signal
import sys
import threading
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
    for stream in filter(None, (sys.stdout, sys.stderr)):
        stream.reconfigure(errors="replace")
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # files that are being written are removed
    ended = _ending_soon()
    try:
        from metafem.cli.group import main

        main(prog_name="metafem")
    except KeyboardInterrupt:
        sys.exit(130)
    finally:
        ended.set()


def _ending_soon() -> threading.Event:
    """End the process soon after Ctrl-C, also within a factorisation, until the returned event is set.

    Python raises KeyboardInterrupt only when such a call of a library returns, which may take seconds.
    """
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    signal.set_wakeup_fd(writing)
    ended = threading.Event()

    def watch() -> None:
        while os.read(reading, 1)[0] != signal.SIGINT:
            pass
        if not ended.wait(LEAVE):
            os.write(2, b"stopped\n")
            os._exit(130)

    if sys.argv[1:2] != ["explore"]:  # whose server ends by itself
        threading.Thread(target=watch, daemon=True).start()
    return ended


def __getattr__(name: str) -> Any:
    """Return `main`, the group of commands, which is imported only when it is used."""
    if name != "main":
        raise AttributeError(f"module {__name__} has no attribute {name}")
    from metafem.cli.group import main

    return main
