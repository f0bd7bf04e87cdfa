"""Overhead and equal numbers of batches on processes and clusters, with a worker that is killed."""

from __future__ import annotations

import tempfile
import time
from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path

import metafem as mf
from metafem.studies import Execution
from validation.scenes.batches import Waiting, cluster, collected, overhead
from validation.timing import Row

# Batches of a run; one worker computes half as many.
BATCHES = 24

# Nothing listens there.
NOWHERE = "tcp://127.0.0.1:1"


def rows() -> Iterator[Row]:
    """Measure overheads at batches of half a second, and compare the numbers."""
    with tempfile.TemporaryDirectory() as name:
        task, deadly = Waiting(Path(name)), Waiting(Path(name), BATCHES // 2)
        expected = collected(Execution(), task, BATCHES)
        yield Row("this process: overhead", 0.05, overhead(Execution(), task, BATCHES // 2, 1))
        two = Execution(workers=2)
        yield Row("2 processes: overhead", 0.05, overhead(two, task, BATCHES, 2))
        died = Path(name, "died")
        for execution, what, count in _executions():
            with execution as used:
                if count <= 2 and used.scheduler:
                    cost = overhead(used, task, BATCHES // (3 - count), count)
                    yield Row(f"{what}: overhead", 0.05, cost)
                died.unlink(missing_ok=True)
                wrong = (collected(used, deadly, BATCHES) != expected).sum() + (not died.exists())
            yield Row(f"{what}, one killed: numbers that differ", 0.0, wrong)
    start = time.perf_counter()
    surface = mf.Surface([[0.0, 0.0], [1.5, 0.0]], [0.1, 0.12], 0.526, mf.Material(1.36))
    try:
        mf.studies.manufacturing(surface, 0.001, execution=Execution(scheduler=NOWHERE))
    except mf.InvalidInput:
        taken = time.perf_counter() - start
    yield Row("a scheduler that does not answer is named: time", 10.0, taken, "s")


def _executions():
    """Return runs in processes and on clusters, with their names and numbers of workers."""
    yield nullcontext(Execution(workers=2)), "2 processes", 2
    for workers in (1, 2, 4):
        yield cluster(workers), f"cluster of {workers}", workers
