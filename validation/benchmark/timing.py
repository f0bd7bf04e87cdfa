"""Rows of wanted and measured times."""

from __future__ import annotations

import resource
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One measured number beside the one that is wanted, in the same unit."""

    what: str
    wanted: float
    measured: float
    unit: str


def best(work: Callable[[], object], repeats: int) -> float:
    """Shortest of several runs [s], the first of which only warms up."""
    work()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return min(times)


def processor_time(command: list[str], repeats: int = 3) -> float:
    """Least processor time of a command [s], after one run that warms the file cache."""
    times = []
    for _ in range(repeats + 1):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        times.append(after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime)
    return min(times[1:])
