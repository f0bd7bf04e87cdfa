"""Threads and memory: what a solver may use of the machine."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import numpy as np

from metafem.errors import InvalidInput

THREADS = 2

# Assumed where the system does not tell: what a common laptop has [bytes].
DEFAULT_MEMORY = 8 * 2**30


def run_rows(run: Callable[[slice], None], rows: int, work: int, work_per_thread: int) -> None:
    """Call `run` on slices that cover the rows; a second thread is started where the work pays for it.

    Each row is computed alone, so the number of threads changes no number.
    """
    pieces = min(THREADS, 1 + work // work_per_thread, rows)
    edges = np.linspace(0, rows, pieces + 1).astype(int).tolist()
    slices = [slice(start, end) for start, end in pairwise(edges)]
    if pieces == 1:
        run(slices[0])
        return
    with ThreadPoolExecutor(pieces) as pool:
        list(pool.map(run, slices))


def memory() -> int:
    """Return the machine's memory [bytes]."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return DEFAULT_MEMORY


def require_memory(needed: float, what: str) -> None:
    """Raise InvalidInput where `needed` bytes exceed the machine's memory, before they are allocated."""
    there = memory()
    if needed > there:
        raise InvalidInput(
            f"{what} would need {needed / 2**30:.1f} GiB of memory, and the machine has {there / 2**30:.1f}"
        )
