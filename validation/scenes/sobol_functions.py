"""Two functions of three inputs whose means, deviations and Sobol indices are known."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.special import ndtri

from metafem.studies.sampling.sobol_indices import SobolIndices, batch_means, estimated, exchanged, plan

GROUPS = ((0,), (1,), (2,))

# Ishigami and Homma (1990), doi:10.1109/ISUMA.1990.151285, with a = 7 and b = 0.1: variances of the effects
# of x1, of x2, and of x1 and x3 together.
ALONE_1, ALONE_2, TOGETHER = 0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 49.0 / 8.0, 0.08 * np.pi**8 / 225.0
VARIANCE = ALONE_1 + ALONE_2 + TOGETHER

# Coefficients of a linear law of Gaussian inputs.
LINEAR = np.array([3.0, 1.0, 0.3])
SHARE = LINEAR**2 / (LINEAR @ LINEAR)

# Mean, deviation, first-order and total indices; columns: Ishigami, linear.
EXACT = (
    np.array([3.5, 0.0]),
    np.sqrt([VARIANCE, LINEAR @ LINEAR]),
    np.transpose([np.array([ALONE_1, ALONE_2, 0.0]) / VARIANCE, SHARE]),
    np.transpose([np.array([ALONE_1 + TOGETHER, ALONE_2, TOGETHER]) / VARIANCE, SHARE]),
)


def both(unit: np.ndarray) -> np.ndarray:
    """Return the Ishigami function and the linear law (..., 2) at points of the unit cube (..., 3)."""
    x, y, z = np.moveaxis(np.pi * (2.0 * unit - 1.0), -1, 0)
    ishigami = np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)
    return np.stack([ishigami, ndtri(unit) @ LINEAR], axis=-1)


def sobol_indices(
    function: Callable[[np.ndarray], np.ndarray], groups: Sequence[Sequence[int]], draws: int, seed: int
) -> SobolIndices:
    """Estimate mean, deviation and Sobol indices of a function of groups of inputs in the unit cube."""
    batches, points = plan(draws, len(groups))
    centre = function(np.full(sum(map(len, groups)), 0.5))
    drawn = (function(exchanged(seed, batch, groups, points)) for batch in range(batches))
    return estimated(np.array([batch_means(values, centre) for values in drawn]), centre)


def coverage(repetitions: int, draws: int) -> np.ndarray:
    """Return the share of repetitions whose intervals hold the exact value, (8, 2).

    Rows: mean, deviation, three first-order and three total indices. Columns: Ishigami, linear.
    """
    inside = np.zeros((8, 2))
    for seed in range(repetitions):
        found = sobol_indices(both, GROUPS, draws, seed)
        inside += np.vstack(
            [
                np.abs(estimate.value - exact) <= estimate.error
                for estimate, exact in zip(found, EXACT, strict=True)
            ]
        )
    return inside / repetitions
