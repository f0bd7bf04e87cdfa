"""How much chi-square grows at the ends of 68 % intervals of a bent line, by simulation.

For given crossover c the model is linear in the level and the slopes, if the errors of the load count as
errors of the friction in proportion to the slope. Simulated laws on the fitted lines then need no search:
chi-square follows from projections that are the same for all of them.
"""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.measured_law.bent_line import KINK, LEFT, RIGHT, Points, kink_grid

# 68 %, and that quantile of chi-square with one degree of freedom.
LEVEL_OF_INTERVALS, REGULAR_GROWTH = 0.68, 0.98894665

# Number of crossovers at which chi-square of a simulated law is computed, beside the true one.
TRIED = 25


def growths(points: Points, p: FloatArray, draws: int, rng: np.random.Generator) -> FloatArray:
    """Return the growths of chi-square (3, b) at the ends of the intervals of crossover and slopes.

    They are the 68 % quantiles of the difference of chi-square, at the true value of the parameter and
    minimised over all others, from its minimum. For a crossover at the end of its range the growth is smaller
    than that of the regular case, which is taken instead: the true crossover is not at the end.
    """
    found = [
        _quantiles(points.take(np.array([i])), p[i], rng.standard_normal((draws, points.x.shape[1])))
        for i in range(len(p))
    ]
    growth = np.array(found).T
    growth[0] = np.maximum(growth[0], REGULAR_GROWTH)
    return growth


def _quantiles(points: Points, p: FloatArray, error: FloatArray) -> FloatArray:
    """Return the quantiles of one law (3,) from errors (draws, n) in standard deviations."""
    x, c = points.x[0], p[KINK]
    tried = np.append(c, kink_grid(points.x, TRIED)[0])
    dx = x - tried[:, None]
    slope = np.where(x < c, p[LEFT], p[RIGHT])
    root = 1.0 / np.sqrt(points.sy[0] ** 2 + (slope * points.sx[0]) ** 2)
    columns = root[:, None] * np.stack([np.ones_like(dx), np.minimum(dx, 0.0), np.maximum(dx, 0.0)], axis=-1)
    # the level at the crossover changes nothing
    law = root * slope * (x - c) + error
    square = (law**2).sum(axis=1)
    base = np.linalg.qr(columns)[0]
    value = square - (np.einsum("kni,tn->kti", base, law, optimize=True) ** 2).sum(axis=-1)
    smallest = value.min(axis=0)
    growth = [value[0] - smallest]
    for index in (LEFT, RIGHT):
        fixed = p[index] * columns[:, :, index - 1]
        free = np.linalg.qr(np.delete(columns, index - 1, axis=2))[0]
        along = np.einsum("kni,tn->kti", free, law, optimize=True)
        along -= np.einsum("kni,kn->ki", free, fixed)[:, None]
        rest = square - 2.0 * fixed @ law.T + (fixed**2).sum(axis=1)[:, None] - (along**2).sum(axis=-1)
        growth.append(np.minimum(rest.min(axis=0), rest[0]) - smallest)
    found: FloatArray = np.quantile(np.array(growth), LEVEL_OF_INTERVALS, axis=1)
    return found
