"""Batches of known length, and a cluster on this machine of which one worker is killed."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from metafem.studies import Execution
from metafem.studies.sampling.batches import opened

# Length of a batch [s].
LENGTH = 0.5


@dataclass(frozen=True)
class Waiting:
    """Batches that take half a second; the one with the number `deadly` ends its process the first time."""

    folder: Path
    deadly: int = -1

    def __call__(self, batch: int) -> dict[str, np.ndarray]:
        """Return random numbers of the batch."""
        died = self.folder / "died"
        if batch == self.deadly and not died.exists():
            died.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(LENGTH)
        return {"value": np.random.default_rng(np.random.SeedSequence(0, spawn_key=(batch,))).random(1000)}


def collected(execution: Execution, task: Waiting, count: int) -> np.ndarray:
    """Return the results of all batches, (count, 1000)."""
    with opened(execution, "waiting", "0" * 32) as compute:
        return np.array([result["value"] for result in compute(task, range(count))])


def overhead(execution: Execution, task: Waiting, count: int, workers: int) -> float:
    """Return the time beyond that of the batches alone, relative; start-up is excluded."""
    with opened(execution, "waiting", "0" * 32) as compute:
        list(compute(task, range(2 * workers)))
        start = time.perf_counter()
        list(compute(task, range(count)))
        return (time.perf_counter() - start) / (LENGTH * count / workers) - 1.0


@contextmanager
def cluster(workers: int) -> Iterator[Execution]:
    """Start a Dask cluster on this machine."""
    from distributed import LocalCluster

    with LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None) as local:
        yield Execution(scheduler=local.scheduler_address)
