"""Runs of many independent batches, with results that do not depend on where they are computed."""

from __future__ import annotations

import itertools
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from metafem import _validate as check
from metafem._given import Given
from metafem.errors import InvalidInput, MetafemError, refuse_if
from metafem.progress import each, message
from metafem.studies.sampling.store import Result, Store, own_version

Task = Callable[[int], Result]

# Computes batches, and yields their results in the order of the numbers.
Run = Callable[[Task, Sequence[int]], Iterator[Result]]

# Number of times a batch may end its worker before it is abandoned.
MOST_DEATHS = 3

# Largest number of batches on a cluster at a time; their results are small.
AHEAD = 256

# Seconds within which a scheduler must answer; a running one takes milliseconds.
PATIENCE = 4

# The remedy without a cluster; its field is the argument for processes.
INSTEAD = "or leave scheduler out and use {.name} on this machine"


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


def here(task: Task, numbers: Sequence[int]) -> Iterator[Result]:
    """Compute batches in this process."""
    yield from map(task, numbers)


def processes(workers: int) -> Run:
    """Return a run in several processes of this machine; the batches of a dead one are computed again."""

    def run(task: Task, numbers: Sequence[int]) -> Iterator[Result]:
        from joblib import Parallel, delayed
        from joblib.externals.loky.process_executor import TerminatedWorkerError

        left, deaths = deque(numbers), 0
        while left:
            pool = Parallel(n_jobs=workers, return_as="generator", batch_size=1, pre_dispatch="2 * n_jobs")
            results = pool(delayed(task)(number) for number in tuple(left))
            try:
                for result in results:
                    left.popleft()
                    deaths = 0
                    yield result
            except TerminatedWorkerError as error:
                deaths += 1
                if deaths == MOST_DEATHS:
                    raise MetafemError(
                        f"batch {left[0]} or one that ran with it ended its process {deaths} times, for "
                        f"example for lack of memory: {error}"
                    ) from None
            finally:
                results.close()

    return run


@contextmanager
def cluster(address: str) -> Iterator[Run]:
    """Connect with a Dask scheduler; it computes the batches of dead workers again."""
    try:
        from distributed import CancelledError, Client, KilledWorker
        from distributed.comm.addressing import resolve_address
    except ImportError:
        raise InvalidInput(
            f"scheduler = {address!r} needs the extra cluster: pip install 'metafem[cluster]'"
        ) from None
    given: dict[str, Any] = {"key": "scheduler", "value": repr(address)}
    try:
        # a client with an unusable address ends with its own errors
        resolve_address(address)
        client: Any = Client(address, timeout=PATIENCE, set_as_default=False)  # type: ignore[no-untyped-call]
    except (OSError, ValueError, TypeError) as error:
        why = Given("error", str(error) or type(error).__name__)
        words = f"does not answer ({{.number}}): start it with `dask scheduler`, {INSTEAD}"
        raise InvalidInput(words, why, Given("workers=2"), **given) from None
    try:
        words = f"has no workers: start `dask worker`, {INSTEAD}"
        refuse_if(not client.nthreads(), words, Given("workers=2"), **given)
        _require_same_version(client, address)

        def run(task: Task, numbers: Sequence[int]) -> Iterator[Result]:
            waiting: deque[Any] = deque()
            unsent = deque(numbers)
            while unsent or waiting:
                while unsent and len(waiting) < AHEAD:
                    waiting.append(client.submit(task, unsent.popleft(), pure=False))
                try:
                    yield waiting.popleft().result()
                except KilledWorker as error:
                    raise MetafemError(f"a batch ended several workers of {address}: {error}") from None
                except CancelledError:
                    raise MetafemError(
                        f"the connection with the scheduler {address} was lost: start it again and repeat "
                        "the call; finished batches that are kept in a folder are not computed again"
                    ) from None

        yield run
    finally:
        with suppress(Exception):  # the scheduler may be gone
            client.close()


def _require_same_version(client: Any, address: str) -> None:
    """Refuse workers without metafem or with another version, which may compute other numbers."""
    try:
        found = set(client.run(own_version).values())
    except ImportError as error:
        raise InvalidInput(f"the workers of {address} cannot import metafem: {error}") from None
    words = (
        f"the workers of {address} have metafem {', '.join(sorted(found))}, and this machine {own_version()}"
    )
    refuse_if(found != {own_version()}, words)
