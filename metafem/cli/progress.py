"""Progress of a command: step, completed fraction and elapsed time."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

import metafem as mf
from metafem import _caches
from metafem.progress import doing, listening

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Console

    from metafem.inversion import Design
    from metafem.progress import OnStep

# Time before the first line and between two lines, if the output is not a terminal [s].
FIRST_LINE, NEXT_LINE = 5.0, 10.0


@contextmanager
def progress() -> Iterator[None]:
    """Show the running step and the elapsed time on stderr, and print when kernels are first compiled."""
    from rich.console import Console

    from metafem._kernels.compiled import on_first_compilation

    console = Console(stderr=True)

    def say(text: str) -> None:
        console.print(text, highlight=False, markup=False, soft_wrap=True)

    on_first_compilation(lambda: say(f"compiling kernels, {_how_often()} …"))
    shown = _status if console.is_terminal else _lines
    with shown(console) as on_step, listening(on_step, say):
        yield


def _how_often() -> str:
    """Return a phrase that states whether kernels are compiled only once or for each command."""
    with suppress(OSError):
        folder = _caches.kernel_folder()
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return "once for this installation"
    return "again for each command, because the cache cannot be written (see metafem doctor)"


@contextmanager
def _status(console: Console) -> Iterator[OnStep]:
    """Show the step, the completed fraction and the elapsed time in one line, which is updated."""
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting")
        yield lambda step, done: bar.update(task, description=worded(step, done))


@contextmanager
def _lines(console: Console) -> Iterator[OnStep]:
    """Print the step after `FIRST_LINE` seconds, and then every `NEXT_LINE` seconds."""
    start, ended, text = time.monotonic(), threading.Event(), ""

    def on_step(step: str, done: float | None) -> None:
        nonlocal text
        text = worded(step, done)

    def report() -> None:
        wait = FIRST_LINE
        while not ended.wait(wait):
            if text:
                seconds = time.monotonic() - start
                console.print(f"{text} ({seconds:.0f} s)", highlight=False, markup=False, soft_wrap=True)
            wait = NEXT_LINE

    # a separate thread prints, because solvers report only the beginning of a step, and a step may be long
    thread = threading.Thread(target=report, daemon=True)
    thread.start()
    try:
        yield on_step
    finally:
        ended.set()
        thread.join()


def worded(step: str, done: float | None) -> str:
    """Return the text of a step with its completed fraction."""
    return step if done is None else f"{step}, {100.0 * done:.0f} %"


def loaded(folder: Path) -> Design:
    """Return the design in a result folder."""
    with doing("reading the design"):
        return mf.load(folder)
