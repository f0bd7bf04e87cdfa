"""The metafem command: parse, call, print."""

import os
from typing import Any

from metafem.cli.signals import report_stop, stopped_by_signals

__all__ = ["main", "run"]


def run() -> None:
    """Run the metafem command. It is stopped by signals from here on, while its modules are imported too.

    The dense systems of a design are small: threads of BLAS only wait for each other, on a busy machine for
    ten times as long, and the last digit can depend on their number. So there is one thread, unless the user
    chose another number.
    """
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # read once, when numpy is imported
    with stopped_by_signals(last=True):
        with report_stop("nothing was written"):
            from metafem.cli.commands import main
        main(prog_name="metafem")


def __getattr__(name: str) -> Any:
    """Import the group of commands, `main`, when it is first used."""
    if name != "main":
        raise AttributeError(f"module {__name__} has no attribute {name}")
    from metafem.cli.commands import main

    return main
