"""Progress of a command on a terminal: step, completed fraction and elapsed time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import TYPE_CHECKING

import metafem as mf
from metafem.progress import doing, listening

if TYPE_CHECKING:
    from pathlib import Path

    from metafem.inversion import Design


@contextmanager
def progress() -> Iterator[None]:
    """Show the running step on a terminal, and print on stderr when kernels are first compiled."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    from metafem._kernels.compiled import on_first_compilation

    console = Console(stderr=True)

    def say(text: str) -> None:
        console.print(text, highlight=False, markup=False, soft_wrap=True)

    on_first_compilation(lambda: say("compiling kernels for this installation …"))
    columns = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
    bar = Progress(*columns, console=console, transient=True)
    task = bar.add_task("starting")

    def on_step(step: str, done: float | None) -> None:
        bar.update(task, description=step if done is None else f"{step}, {100.0 * done:.0f} %")

    with bar if console.is_terminal else nullcontext(), listening(on_step, say):
        yield


def loaded(folder: Path) -> Design:
    """Return the design in a result folder."""
    with doing("reading the design"):
        return mf.load(folder)
