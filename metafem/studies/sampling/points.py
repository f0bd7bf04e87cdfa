"""Random points of the unit cube in batches: each batch depends only on the seed and its number."""

from __future__ import annotations

from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray

# Distance of the points from 0 and from 1, so that their normal quantiles are finite.
SMALLEST = 0.5**54


def entropy(rng: Any) -> int:
    """Return the random seed of a run: `rng` itself if it is an integer, else an integer that it draws."""
    random = check.generator(rng)
    if isinstance(rng, (int, np.integer)):
        return int(rng)
    return int(random.integers(2**63))


def generator_of(seed: int, batch: int) -> np.random.Generator:
    """Return the generator of a batch."""
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(batch,)))


def unit_points(seed: int, batch: int, size: int, dimensions: int) -> FloatArray:
    """Return the points of one batch in the open unit cube, (size, dimensions)."""
    points = generator_of(seed, batch).random((size, dimensions))
    return np.clip(points, SMALLEST, 1.0 - 2.0 * SMALLEST)
