"""Points of the unit cube in batches: each batch depends only on the seed and its number."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import InvalidInput

# Number of bits of the coordinates of Sobol points; the default of scipy.
BITS = 30

# Largest dimension of scipy's Sobol points; above this dimension, plain random points are used.
MOST_DIMENSIONS = 21_201

# Smallest number of batches from which errors are estimated; with fewer, the 68 % factor of Student's
# distribution exceeds 1.04.
FEWEST_BATCHES = 16

# Largest number of points of one batch, and largest number of their coordinates, which take 8 MiB. For 64
# asperities, 4,096 points take 2 MiB; larger nets would be more accurate.
MOST_POINTS, MOST_NUMBERS = 4096, 2**20

# Number of batches whose points stay in memory for the next level of the errors, and largest number of
# coordinates of such a batch, which take 2 MiB.
MOST_KEPT, LARGEST_KEPT = 20, 2**18

# Largest number of draws if draws are added until an error is reached.
MOST_DRAWS = 10**6


@dataclass(frozen=True)
class Draws:
    """Number of draws of a study.

    Parameters
    ----------
    number : int
        Number of draws, at least 2, rounded up to full batches; default: 10,000.
    error : float, optional
        Required sampling error [-], in place of a number: draws are added until the error is reached, up to
        a million. Each study states which of its results has this error.
    plain : bool
        Use plain random numbers without control variates, for comparison; default: False.

    Raises
    ------
    InvalidInput
        For fewer than two draws, an error that is not positive, and an error together with ``plain=True``.

    Examples
    --------
    >>> Draws(error=0.01).number
    10000
    """

    number: int = 10_000
    error: float | None = None
    plain: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "number", check.integer("draws", self.number, at_least=2))
        check.member(self, "error", optional=True, above=0.0)
        if self.error is not None and self.plain:
            raise InvalidInput("error cannot be given with plain=True; state the number of draws")

    @staticmethod
    def of(draws: int | Draws) -> Draws:
        """Return `draws` as a value of this class; a number becomes ``Draws(number)``."""
        return draws if isinstance(draws, Draws) else Draws(draws)


def entropy(rng: Any) -> int:
    """Return the random seed of a run: `rng` itself if it is an integer, else an integer that it draws."""
    random = check.generator(rng)
    if isinstance(rng, (int, np.integer)):
        return int(rng)
    return int(random.integers(2**63))


def batch_size(draws: int, dimensions: int = 1) -> int:
    """Return the number of points of one batch, a power of two.

    Examples
    --------
    >>> batch_size(2), batch_size(10_000, 64), batch_size(10**7, 64), batch_size(10**7, 4096)
    (1, 512, 4096, 256)
    """
    most = min(draws // FEWEST_BATCHES, MOST_NUMBERS // max(dimensions, 1), MOST_POINTS)
    return 1 << (max(most, 1).bit_length() - 1)


def unit_points(seed: int, batch: int, size: int, dimensions: int, *, plain: bool = False) -> FloatArray:
    """Return the points of one batch in the open unit cube, (size, dimensions).

    Each batch has Sobol points with its own scrambling, so that batches are independent and each batch is
    uniform. If `plain`, the points are plain random numbers. size: a power of two unless `plain`.
    """
    small = size * dimensions <= LARGEST_KEPT
    return (_points if small else _points.__wrapped__)(seed, batch, size, dimensions, plain)


@lru_cache(MOST_KEPT)
def _points(seed: int, batch: int, size: int, dimensions: int, plain: bool) -> FloatArray:
    """Return the points as a read-only array."""
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(batch,)))
    if plain or size == 1 or not 0 < dimensions <= MOST_DIMENSIONS:
        smallest = 0.5**54
        points = np.clip(random.random((size, dimensions)), smallest, 1.0 - 2.0 * smallest)
    else:
        from scipy.stats import qmc

        net = qmc.Sobol(dimensions, scramble=True, bits=BITS, rng=random).random(size)
        points = net + 0.5 ** (BITS + 1)  # centres of the rounding intervals, so that none is 0
    points.flags.writeable = False
    return points
