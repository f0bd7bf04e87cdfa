"""Threads and memory of the solvers."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import numpy as np

from metafem.errors import InvalidInput

# Number of threads of a solver and of its Fourier transforms. Times in comments were measured on two cores.
THREADS = 2


def run_rows(run: Callable[[slice], None], rows: int, work: int, work_per_thread: int) -> None:
    """Call `run` with slices that cover all rows, in two threads if there is enough work.

    Each row is computed separately, so the results do not depend on the number of threads.
    """
    pieces = min(THREADS, 1 + work // work_per_thread, rows)
    if pieces <= 1:
        run(slice(0, rows))
        return
    edges = np.linspace(0, rows, pieces + 1).astype(int).tolist()
    slices = [slice(start, end) for start, end in pairwise(edges)]
    with ThreadPoolExecutor(pieces) as pool:
        list(pool.map(run, slices))


def memory() -> int:
    """Return the machine's memory [bytes]."""
    try:
        return os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    except (AttributeError, ValueError, OSError):
        return 8 * 2**30  # a common laptop


def require_memory(needed: float, what: str) -> None:
    """Raise InvalidInput if `needed` bytes exceed the machine's memory; call it before the allocation."""
    there = memory()
    if needed > there:
        raise InvalidInput(
            f"{what} would need {needed / 2**30:.1f} GiB of memory, and the machine has {there / 2**30:.1f}"
        )
