"""What is being done, shown while it is done."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def progress(first: str) -> Iterator[Callable[[str], None]]:
    """Show what is being done on a terminal, and say once when kernels are compiled."""
    from rich.console import Console

    from metafem._kernels.notice import on_first_compilation

    console = Console(stderr=True)
    on_first_compilation(lambda: console.print("compiling kernels, once for this installation …"))
    if not console.is_terminal:
        yield lambda text: None
        return
    with console.status(first) as status:
        yield status.update
