"""Runs of many independent batches, with results that do not depend on where they are computed."""

from __future__ import annotations

import itertools
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path

from metafem import _validate as check
from metafem.errors import refuse_if
from metafem.progress import each, message
from metafem.studies.sampling.schedulers import Run, Task, cluster, here, processes
from metafem.studies.sampling.store import Result, Store


@dataclass(frozen=True)
class Execution:
    """Where the draws of a study are computed, and where finished batches are stored.

    The results do not depend on it: the random numbers of a batch follow from the seed and the number of the
    batch. On different processors the last bits of the areas may differ.

    Parameters
    ----------
    workers : int
        Number of processes on this machine, at least 1; default: 1, this process.
    scheduler : str, optional
        Address of a Dask scheduler, such as ``"tcp://10.0.0.1:8786"``, in place of processes; needs the
        extra ``cluster``.
    folder : str or Path, optional
        A new or empty folder in which finished batches are stored. The same call with the same folder
        continues a stopped run; a folder with another run is refused. Default: nothing is stored.

    Raises
    ------
    InvalidInput
        For fewer than one worker, and for workers together with a scheduler. When a study runs, for a
        scheduler that does not answer within 10 s, and a folder that cannot be used.

    Examples
    --------
    >>> Execution(workers=2)
    Execution(workers=2, scheduler=None, folder=None)
    """

    workers: int = 1
    scheduler: str | None = None
    folder: str | Path | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "workers", check.integer("workers", self.workers, at_least=1))
        both = self.scheduler is not None and self.workers > 1
        words = "cannot be given with a scheduler, which has its own workers"
        refuse_if(both, words, key="workers", value=self.workers)


@contextmanager
def opened(execution: Execution | None, study: str, inputs: str) -> Iterator[Run]:
    """Open a run; its value computes batches of a task and yields their results in order of their numbers.

    inputs: hash of everything the results depend on. Ctrl-C reports where the finished batches are. The
    folder of a run has its batches in the order in which they are wanted, whatever their task.
    """
    chosen = Execution() if execution is None else execution
    store = None if chosen.folder is None else Store.opened(Path(chosen.folder), study, inputs)
    local = nullcontext(here if chosen.workers == 1 else processes(chosen.workers))
    place = itertools.count()
    try:
        with local if chosen.scheduler is None else cluster(chosen.scheduler) as compute:
            yield lambda task, numbers: _results(
                store, compute, task, dict(zip(numbers, place, strict=False))
            )
    except (KeyboardInterrupt, SystemExit) as stop:
        if store is not None:
            text = f"finished batches are kept in {store.folder}; the same call with this folder goes on"
            stop.add_note(text)
            message(text)
        raise


def _results(store: Store | None, compute: Run, task: Task, places: Mapping[int, int]) -> Iterator[Result]:
    """Yield results in order: those at their places in the store are read, the others computed and stored."""
    kept = {} if store is None else {number: store.read(place) for number, place in places.items()}
    missing = [number for number in places if kept.get(number) is None]
    fresh, start, done = compute(task, missing), time.monotonic(), 0

    def rate() -> str:
        """Return the batches per second of this run, and the time left."""
        if not done:
            return ""
        taken = (time.monotonic() - start) / done
        return f"{1.0 / taken:.2g} per second, {(len(missing) - done) * taken:.0f} s left"

    for number in each("batch", list(places), detail=rate):
        result = kept.pop(number, None)
        if result is None:
            result = next(fresh)
            done += 1
            if store is not None:
                store.write(places[number], result)
        yield result
