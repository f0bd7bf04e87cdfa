"""Rows of required and measured numbers, and how times are measured."""

from __future__ import annotations

import os
import statistics
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

# Times are medians of this many runs, or of as many as take so long together [s], but at least of LEAST; a
# run longer than LONG is not repeated [s].
REPEATS, ENOUGH, LEAST, LONG = 50, 0.2, 3, 0.3


@dataclass(frozen=True)
class Row:
    """A measured number and the largest one that is allowed, in the same unit."""

    what: str
    required: float
    measured: float
    unit: str = ""


def took(work: Callable[[], Any]) -> tuple[float, Any]:
    """Seconds of one run, and its result."""
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result


def timed(work: Callable[[int], Any]) -> tuple[float, list[Any]]:
    """Median seconds of several runs, one if it is long, and their answers; the work is told the run."""
    times: list[float] = []
    answers: list[Any] = []
    while len(times) < LEAST or (len(times) < REPEATS and sum(times) < ENOUGH):
        seconds, answer = took(lambda: work(len(times)))
        times.append(seconds)
        answers.append(answer)
        if times[0] > LONG:
            break
    return statistics.median(times), answers


def spent(command: Sequence[str], **options: Any) -> tuple[float, float]:
    """Run a command, which must end with 0, and return its seconds and its peak memory [GiB]."""
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command, **quiet, **options)
    seconds, (_, status, used) = took(lambda: os.wait4(process.pid, 0))
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        raise subprocess.CalledProcessError(process.returncode, command)
    return seconds, used.ru_maxrss / 2**20
