"""Where batches are computed: in this process, in several, or on a Dask cluster."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from typing import Any

from metafem._given import Given
from metafem.errors import InvalidInput, MetafemError, refuse_if
from metafem.studies.sampling.store import Result, own_version

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
