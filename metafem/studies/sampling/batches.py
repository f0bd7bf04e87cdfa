"""Independent batches, computed in this process or as `joblib.parallel_config` says."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeVar

from metafem.progress import each

Result = TypeVar("Result")


def computed(task: Callable[[int], Result], numbers: Sequence[int]) -> Iterator[Result]:
    """Yield the results of a task in the order of the batch numbers.

    The results do not depend on the number of workers, because the random numbers of a batch follow from the
    seed and the batch number.

    Examples
    --------
    >>> import joblib
    >>> with joblib.parallel_config(n_jobs=1):
    ...     list(computed(abs, range(-1, 2)))
    [1, 0, 1]
    """
    from joblib import Parallel, delayed

    results = Parallel(return_as="generator", batch_size=1)(delayed(task)(number) for number in numbers)
    for _ in each("batch", numbers):
        yield next(results)
