"""Runs of many independent batches, with results that do not depend on where they are computed."""

from __future__ import annotations

import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path

from metafem import _validate as check
from metafem.errors import InvalidInput
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
        if self.scheduler is not None:
            check.instance("scheduler", self.scheduler, str, "an address such as tcp://10.0.0.1:8786")
            if self.workers > 1:
                raise InvalidInput(
                    f"workers = {self.workers} cannot be given with a scheduler, which has its own workers"
                )
        if self.folder is not None:
            check.instance("folder", self.folder, (str, Path), "the name of a folder")  # type: ignore[arg-type]


@contextmanager
def opened(execution: Execution | None, study: str, inputs: str) -> Iterator[Run]:
    """Open a run; its value computes batches of a task and yields their results in order of their numbers.

    inputs: hash of everything the results depend on. Ctrl-C reports where the finished batches are.
    """
    chosen = Execution() if execution is None else execution
    check.instance("execution", chosen, Execution, "a metafem.studies.Execution")
    store = None if chosen.folder is None else Store.opened(Path(chosen.folder), study, inputs)
    local = nullcontext(here if chosen.workers == 1 else processes(chosen.workers))
    try:
        with local if chosen.scheduler is None else cluster(chosen.scheduler) as compute:
            yield lambda task, numbers: _results(store, compute, task, numbers)
    except (KeyboardInterrupt, SystemExit) as stop:
        if store is not None:
            text = f"finished batches are kept in {store.folder}; the same call with this folder goes on"
            stop.add_note(text)
            message(text)
        raise


def _results(store: Store | None, compute: Run, task: Task, numbers: Sequence[int]) -> Iterator[Result]:
    """Yield results in order: stored ones are read, the others are computed and stored."""
    stored = set() if store is None else set(filter(store.holds, numbers))
    missing = [number for number in numbers if number not in stored]
    fresh, start, done = compute(task, missing), time.monotonic(), 0

    def rate() -> str:
        """Return the batches per second of this run, and the time left."""
        if not done:
            return ""
        taken = (time.monotonic() - start) / done
        return f"{1.0 / taken:.2g} per second, {(len(missing) - done) * taken:.0f} s left"

    for number in each("batch", numbers, detail=rate):
        result = store.read(number) if store is not None and number in stored else None
        if result is None:
            # a stored batch that cannot be read is computed here
            result = task(number) if number in stored else next(fresh)
            done += number not in stored
            if store is not None:
                store.write(number, result)
        yield result
