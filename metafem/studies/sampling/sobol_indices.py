"""Sobol indices, means and deviations of functions of random inputs, from independent batches of points.

First-order and total indices are ratios of mean products of differences: Azzini, Mara and Rosati, Environ.
Model. Softw. 144, 105167 (2021), doi:10.1016/j.envsoft.2021.105167. The indices do not change if a constant
is added to the function, and are exact if the function depends on one group of inputs only.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, stdtrit

from metafem._validate import FloatArray
from metafem.studies.sampling.moments import Estimate
from metafem.studies.sampling.points import FEWEST_BATCHES, unit_points

# Largest number of points of one batch. With six inputs and 40 outputs, the values at the points take 5 MiB.
MOST_POINTS = 1024


class SobolIndices(NamedTuple):
    """Mean, standard deviation and Sobol indices of k functions of g groups of inputs.

    Attributes
    ----------
    mean, sd : Estimate of (k,)
    first_order : Estimate of (g, k)
        Share of the variance that a group explains by itself.
    total : Estimate of (g, k)
        Share of the variance that would remain if all other inputs were known.
    """

    mean: Estimate
    sd: Estimate
    first_order: Estimate
    total: Estimate


def plan(draws: int, groups: int) -> tuple[int, int]:
    """Return the number of batches, and the number of points per batch, for at least `draws` draws.

    The number of points is a power of two. A draw is one evaluation of the function, and each point takes
    ``2 + 2 groups`` draws.

    Examples
    --------
    >>> plan(10_000, 3)
    (16, 128)
    """
    each = 2 + 2 * groups
    points = 2
    while points < MOST_POINTS and FEWEST_BATCHES * points * each < draws:
        points *= 2
    return max(FEWEST_BATCHES, -(-draws // (points * each))), points


def exchanged(seed: int, batch: int, groups: Sequence[Sequence[int]], points: int) -> FloatArray:
    """Return the points of one batch in the unit cube, (2 + 2 g, points, d).

    The first two sets of points, A and B, are the two halves of the columns of one scrambled Sobol sequence.
    Two more sets follow for each group: A with the group's columns of B, and B with the group's columns of A.
    """
    dimensions = sum(map(len, groups))
    a, b = np.split(unit_points(seed, batch, points, 2 * dimensions), 2, axis=1)
    parts = [a, b]
    for group in groups:
        columns = list(group)
        for one, other in ((a, b), (b, a)):
            mixed = one.copy()
            mixed[:, columns] = other[:, columns]
            parts.append(mixed)
    return np.array(parts)


def batch_means(values: FloatArray, centre: FloatArray) -> FloatArray:
    """Return the means over one batch from which the estimates follow, (2 + 3 g, k).

    The first two rows are the means of the function minus `centre` (k,), a value near its mean, and of the
    square of this difference. For each group, let a, b, a' and b' be the values of the function at A, at B,
    at A with the group's columns of B, and at B with the group's columns of A. The other rows are, each for
    all groups, the means of ``2 (b' - b) (a - a')``, ``(a - a')^2 + (b - b')^2`` and
    ``(a - b)^2 + (a' - b')^2``. Their expectations are 4 V S, 4 V T and 4 V, with the variance V, the
    first-order index S and the total index T.

    values: (2 + 2 g, points, k), the function at the points of `exchanged`.
    """
    a, b, with_b, with_a = values[0], values[1], values[2::2], values[3::2]
    first = 2.0 * ((with_a - b) * (a - with_b)).mean(axis=1)
    total = ((a - with_b) ** 2 + (b - with_a) ** 2).mean(axis=1)
    spread = ((a - b) ** 2 + (with_b - with_a) ** 2).mean(axis=1)
    off = values - centre
    moments = off.mean(axis=(0, 1)), (off**2).mean(axis=(0, 1))
    return np.concatenate([np.array(moments), first, total, spread])


def estimated(means: FloatArray, centre: FloatArray) -> SobolIndices:
    """Return the estimates from the means of m independent batches, (m, 2 + 3 g, k).

    Each estimate is a function of the means over all batches. The jackknife over the batches removes the
    first-order bias of the estimate and gives its error. The error contains the factor of Student's
    distribution with m - 1 degrees of freedom, so that the interval of one error on each side contains the
    true value with a probability of 68 %.
    """
    groups = (means.shape[1] - 2) // 3

    def indices(part: int) -> Estimate:
        rows = slice(2 + part * groups, 2 + (part + 1) * groups)

        def ratio(mean: FloatArray) -> FloatArray:
            spread = mean[..., 2 + 2 * groups :, :]
            # where the function is constant, no input has an influence
            return np.asarray(np.divide(mean[..., rows, :], spread, np.zeros_like(spread), where=spread > 0))

        return jackknife(ratio, means)

    mean = jackknife(lambda mean: mean[..., 0, :], means)
    sd = jackknife(lambda mean: np.sqrt(np.maximum(mean[..., 1, :] - mean[..., 0, :] ** 2, 0.0)), means)
    return SobolIndices(Estimate(mean.value + centre, mean.error), sd, indices(0), indices(1))


def jackknife(statistic: Callable[[FloatArray], FloatArray], means: FloatArray) -> Estimate:
    """Return the jackknife estimate of a statistic of means; the first axis has m independent batches."""
    m = len(means)
    total = means.sum(axis=0)
    without = statistic((total - means) / (m - 1))
    values = m * statistic(total / m) - (m - 1) * without
    # half-width of the two-sided interval with the probability of plus and minus one normal SD
    student = float(stdtrit(m - 1, ndtr(1.0)))
    return Estimate(values.mean(axis=0), student * values.std(axis=0, ddof=1) / np.sqrt(m))
