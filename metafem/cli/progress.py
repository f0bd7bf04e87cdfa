"""Progress of a command: step, fraction done and elapsed time."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

import click

from metafem import _caches
from metafem.progress import listening

if TYPE_CHECKING:
    from rich.console import Console

    from metafem.progress import OnStep

# Without a terminal: seconds before the first line, and between two lines.
FIRST_LINE, NEXT_LINE = 5.0, 10.0

# Interval of the checks whether a line is due [s].
LOOK = 0.5


@contextmanager
def printing_messages() -> Iterator[None]:
    """Print the messages of the body on stderr, such as the columns of a table that are not read."""
    with listening(lambda step, done: None, lambda text: click.echo(text, err=True)):
        yield


@contextmanager
def progress() -> Iterator[None]:
    """Show the running step and the elapsed time on stderr; print once that kernels are compiled."""
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
    """Return a sentence on whether compiled kernels can be stored."""
    with suppress(OSError):
        folder = _caches.kernel_folder()
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return "once for this installation"
    return "again for each command, because the cache cannot be written (see metafem doctor)"


@contextmanager
def _status(console: Console) -> Iterator[OnStep]:
    """Show the step, the completed fraction and the elapsed time in a line that is updated."""
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting")
        yield lambda step, done: bar.update(task, description=worded(step, done))


@contextmanager
def _lines(console: Console) -> Iterator[OnStep]:
    """Print lines during long work, at most one in `NEXT_LINE` seconds."""
    lines = Lines(time.monotonic())
    ended = threading.Event()

    def look() -> None:
        while not ended.wait(LOOK):
            text = lines.due(time.monotonic())
            if text is not None:
                console.print(text, highlight=False, markup=False, soft_wrap=True)

    # solvers report only the beginning of a step, and a step may be long: another thread prints
    thread = threading.Thread(target=look, daemon=True)
    thread.start()
    try:
        yield lines.step
    finally:
        ended.set()
        thread.join()


class Lines:
    """Lines about work that began at a time [s]: when to print them, and their text."""

    def __init__(self, start: float) -> None:
        self.start, self.next = start, start + FIRST_LINE
        self.text = ""

    def step(self, step: str, done: float | None) -> None:
        """Store the running step."""
        self.text = worded(step, done)

    def due(self, now: float) -> str | None:
        """Return the line that is due at a time, or None."""
        if now < self.next or not self.text:
            return None
        self.next = now + NEXT_LINE
        return f"{self.text} ({now - self.start:.0f} s)"


def worded(step: str, done: float | None) -> str:
    """Return a step with the completed fraction."""
    return step if done is None else f"{step}, {100.0 * done:.0f} %"
