"""The metafem command: parse, call, print."""

import os
from typing import Any

from metafem.cli.signals import report_stop, stopped_by_signals

__all__ = ["main", "run"]


def run() -> None:
    """Run the metafem command. Signals stop it from here on, even while its modules are imported.

    The dense systems of a design are small: BLAS threads only wait for each other, up to ten times as long on
    a busy machine, and the last digit can depend on their number. The default is therefore one thread; the
    user can choose another number.
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
