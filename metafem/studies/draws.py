"""Random numbers of the studies, which do not depend on the number of workers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, TypeVar

import numpy as np

from metafem import _validate as check
from metafem.progress import each

Item = TypeVar("Item")
Result = TypeVar("Result")


def seed_of(rng: Any) -> int:
    """Return the random seed of a study: `rng` itself if it is an integer, else an integer that it draws."""
    random = check.generator(rng)
    return int(rng) if isinstance(rng, (int, np.integer)) else int(random.integers(2**63))


def generator_of(seed: int, number: int) -> np.random.Generator:
    """Return the generator of one part of a study, which follows from the seed and the part's number."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))


def computed(task: Callable[[Item], Result], items: Sequence[Item]) -> Iterator[Result]:
    """Yield the results of a task for each item in order, computed as `joblib.parallel_config` says.

    Examples
    --------
    >>> list(computed(abs, range(-1, 2)))
    [1, 0, 1]
    """
    from joblib import Parallel, delayed

    results = Parallel(return_as="generator", batch_size=1)(delayed(task)(item) for item in items)
    for _ in each("batch", items):
        yield next(results)
