"""Labels of the tests of measured points, and resampling of points within each test."""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem import _validate as check
from metafem._given import shown
from metafem.errors import refuse_if


@dataclass(frozen=True)
class Bootstrap:
    """Bootstrap fits: the points of each test are resampled with replacement.

    Parameters
    ----------
    draws : int
        Number of fits, at least 2.
    rng : int or numpy.random.Generator
        Seed or generator; default: 0.

    Raises
    ------
    InvalidInput
        If there are fewer than 2 draws, or if the seed is invalid.

    Examples
    --------
    >>> [rows.tolist() for rows in Bootstrap(draws=2).rows(["a", "a", "b"], at_once=1)]
    [[[1, 1, 2]], [[1, 0, 2]]]
    """

    draws: int
    rng: Any = 0

    def __post_init__(self) -> None:
        check.integer("bootstrap", self.draws, at_least=2)
        check.generator(self.rng)

    def rows(self, group: Sequence[Hashable], at_once: int) -> Iterator[NDArray[np.intp]]:
        """Yield the point numbers (m, k) of at most `at_once` draws; group sizes do not change."""
        rng = check.generator(self.rng)
        members = [
            np.array([i for i, each in enumerate(group) if each == one]) for one in dict.fromkeys(group)
        ]
        step = max(at_once, 1)
        for start in range(0, self.draws, step):
            number = min(step, self.draws - start)
            drawn = [own[rng.integers(len(own), size=(number, len(own)))] for own in members]
            yield np.concatenate(drawn, axis=1)


def labels_of(test: Any, count: int) -> tuple[str, ...]:
    """Return the test label of each point, "" if there are no tests."""
    if test is None:
        return ("",) * count
    wrong = isinstance(test, str) or np.ndim(test) != 1 or len(test) != count
    refuse_if(wrong, f"test = {shown(test)} must hold a label for each of the {count} points")
    return tuple(str(name) for name in test)
