"""The metafem command: parse, call, print."""

from typing import Any

from metafem.cli.signals import report_stop, stopped_by_signals

__all__ = ["main", "run"]


def run() -> None:
    """Run the metafem command. It is stopped by signals from here on, while its modules are imported too."""
    with stopped_by_signals():
        with report_stop("nothing was written"):
            from metafem.cli.commands import main
        main(prog_name="metafem")


def __getattr__(name: str) -> Any:
    """Import the group of commands, `main`, when it is first used."""
    if name != "main":
        raise AttributeError(f"module {__name__} has no attribute {name}")
    from metafem.cli.commands import main

    return main
