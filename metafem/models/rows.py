"""Many surfaces at once, in up to two threads; each row is computed alone, so threads change no number."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

import numpy as np

THREADS = 2


def run_rows(run: Callable[[slice], None], rows: int, work: int, work_per_thread: int) -> None:
    """Call `run` on slices that cover the rows; a second thread is started where the work pays for it."""
    pieces = min(THREADS, 1 + work // work_per_thread, rows)
    edges = np.linspace(0, rows, pieces + 1).astype(int).tolist()
    slices = [slice(start, end) for start, end in pairwise(edges)]
    if pieces == 1:
        run(slices[0])
        return
    with ThreadPoolExecutor(pieces) as pool:
        list(pool.map(run, slices))
