"""The command metafem: it parses options, calls the package and prints the results."""

import os
import signal
import sys
from typing import Any

__all__ = ["main", "run"]


def run() -> None:
    """Run the metafem command; Ctrl-C and SIGTERM end it with the exit codes 130 and 143.

    BLAS uses one thread by default, because the dense systems of a design are small. More threads only wait
    for each other, which takes up to ten times as long on a busy machine, and the last digit of a result can
    depend on their number. OPENBLAS_NUM_THREADS sets another number.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # numpy's import reads this variable
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))  # files that are being written are removed
    try:
        from metafem.cli.group import main

        main(prog_name="metafem")
    except KeyboardInterrupt:
        sys.exit(130)


def __getattr__(name: str) -> Any:
    """Return `main`, the group of commands, which is imported only when it is used."""
    if name != "main":
        raise AttributeError(f"module {__name__} has no attribute {name}")
    from metafem.cli.group import main

    return main
