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

# Function that computes batches of a task, and yields their results in the order of the batch numbers.
Run = Callable[[Task, Sequence[int]], Iterator[Result]]

# Number of consecutive crashes of worker processes after which a run is abandoned.
MOST_DEATHS = 3

# Largest number of batches that a cluster holds at the same time; the results of a batch are small.
AHEAD = 256

# Timeout [s] of the connection to a scheduler; a running scheduler answers within milliseconds.
PATIENCE = 4

# The remedy if there is no cluster; its field is replaced by the argument for local processes.
INSTEAD = "or leave scheduler out and use {.name} on this machine"


@dataclass(frozen=True)
class Execution:
    """Where the draws of a study are computed, and where finished batches are stored.

    The results do not depend on the execution: the random numbers of a batch follow from the seed and the
    batch number. Only the last bits of the areas may differ between different processors.

    Parameters
    ----------
    workers : int
        Number of processes on this machine, at least 1; default: 1, this process.
    scheduler : str, optional
        Address of a Dask scheduler, such as ``"tcp://10.0.0.1:8786"``, in place of processes; needs the
        extra ``cluster``.
    folder : str or Path, optional
        A new or empty folder in which finished batches are stored. The same call with the same folder
        continues a stopped run; the folder of another run is refused. Default: nothing is stored.

    Raises
    ------
    InvalidInput
        For fewer than one worker, and for more than one worker together with a scheduler. When a study
        starts: if the scheduler does not answer within 10 s, or if the folder cannot be used.

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
    """Open a run, and yield the function that computes batches of a task and yields their results in order.

    inputs: hash of everything the results depend on. After Ctrl-C, a message states where the finished
    batches are. The folder numbers the batches of all tasks in the order in which they are requested.
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
    """Yield results in order: stored results are read, the others are computed and stored.

    places: the number under which the store holds each batch.
    """
    kept = {} if store is None else {number: store.read(place) for number, place in places.items()}
    missing = [number for number in places if kept.get(number) is None]
    fresh, start, done = compute(task, missing), time.monotonic(), 0

    def rate() -> str:
        """Return a text with the batches per second of this run and the time left."""
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
    """Compute batches in this process, and yield their results."""
    yield from map(task, numbers)


def processes(workers: int) -> Run:
    """Return a run in several processes of this machine, which repeats the batches of crashed processes."""

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
    """Connect to a Dask scheduler and yield its run; the scheduler repeats the batches of crashed workers."""
    try:
        from distributed import CancelledError, Client, KilledWorker
        from distributed.comm.addressing import resolve_address
    except ImportError:
        raise InvalidInput(
            f"scheduler = {address!r} needs the extra cluster: pip install 'metafem[cluster]'"
        ) from None
    given: dict[str, Any] = {"key": "scheduler", "value": repr(address)}
    try:
        # check the address first: for an unusable address, the client raises errors of other types
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
    """Refuse workers without metafem, or with another version, whose numbers may differ."""
    try:
        found = set(client.run(own_version).values())
    except ImportError as error:
        raise InvalidInput(f"the workers of {address} cannot import metafem: {error}") from None
    words = (
        f"the workers of {address} have metafem {', '.join(sorted(found))}, and this machine {own_version()}"
    )
    refuse_if(found != {own_version()}, words)
