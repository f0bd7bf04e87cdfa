"""Crossover of a measured law with two branches, by a fit of two lines with errors on both axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.laws import MeasuredLaw
from metafem.calibration.statistics import WIDTH, Verdict
from metafem.errors import refuse_if

# Smallest number of points, four parameters and at least three points on each side of the crossover, and
# smallest number of different loads.
FEWEST, DIFFERENT = 7, 4

# Growth of chi-square at the ends of a 68 % interval.
GROWTH = WIDTH**2

# Number of crossovers of a grid, and number of grids, of which each covers the interval that the one before
# finds: two find its ends to a hundredth of its length. The best crossover is that of one more grid.
TRIED, GRIDS = 101, 2

# Number of steps of the fit of two lines. A step reduces the change of the lines by a factor of about 100.
STEPS = 8


@dataclass(frozen=True, eq=False, repr=False)
class Crossover(Value):
    """Two straight lines that meet at the crossover, fitted to a measured law.

    Attributes
    ----------
    crossover_load, crossover_friction : float
        P/E* at which the lines meet, and the rescaled friction there [mm^2].
    slopes : (float, float)
        Slopes below and above the crossover [-].
    crossover_interval : (float, float)
        68 % interval of the crossover [mm^2].
    slope_intervals : ((float, float), (float, float))
        68 % intervals of the slopes.
    verdict : Verdict
        Whether two lines fit the points.
    ambiguous : bool
        Whether the points do not bound the crossover: its interval ends at the third load from an end.

    Examples
    --------
    >>> import metafem as mf
    >>> load = np.linspace(0.02, 0.2, 10)
    >>> area = np.where(load < 0.1, 7.0 * load, 0.7 + 12.5 * (load - 0.1))
    >>> law = MeasuredLaw(load, area=area, load_sd=np.full(10, 1e-3), material=mf.Material(1.0))
    >>> mf.calibration.crossover(law).verdict.fits
    True
    """

    crossover_load: float
    crossover_friction: float
    slopes: tuple[float, float]
    crossover_interval: tuple[float, float]
    slope_intervals: tuple[tuple[float, float], tuple[float, float]]
    verdict: Verdict
    ambiguous: bool


def crossover(law: MeasuredLaw) -> Crossover:
    """Return the fit of two straight lines that meet at a crossover, with errors on both axes.

    Chi-square is minimised over the lines and the true loads for each crossover of a grid between the third
    load and the last but two. The interval of the crossover holds those whose chi-square exceeds the minimum
    by at most 0.989, the 68 % quantile of chi-square with one degree of freedom, and the interval of a slope
    the slopes for which this is so at any crossover. If the error of the crossover is not small compared with
    the spacing of the points, several divisions of the points into two branches fit similarly well, and the
    intervals hold the true value less often: in 63 to 67 % of trials for the data of Fig. 5 of Aymard et al.,
    Science 383, 200 (2024), doi:10.1126/science.adk4234. Muggeo, Stat. Med. 22, 3055 (2003),
    doi:10.1002/sim.1545, treats the case without errors of the load.

    Parameters
    ----------
    law : MeasuredLaw
        Law with at least seven points. The errors of load and friction are assumed to be independent.

    Returns
    -------
    Crossover

    Raises
    ------
    InvalidInput
        If the law has fewer than seven points or fewer than four different loads.

    Examples
    --------
    >>> import metafem as mf
    >>> load = np.linspace(0.02, 0.2, 10)
    >>> area = np.where(load < 0.1, 7.0 * load, 0.7 + 12.5 * (load - 0.1))
    >>> law = MeasuredLaw(load, area=area, load_sd=np.full(10, 1e-3), material=mf.Material(1.0))
    >>> found = mf.calibration.crossover(law)
    >>> np.round(found.slopes, 2), round(found.crossover_load, 4)
    (array([ 7. , 12.5]), 0.1)
    """
    check.instance("law", law, MeasuredLaw, "a metafem.calibration.MeasuredLaw")
    count, different = len(law.load), len(np.unique(law.load))
    refuse_if(count < FEWEST, f"law has {count} points; two lines that meet need at least {FEWEST}")
    few = f"law has {different} different loads; two lines that meet need {DIFFERENT}"
    refuse_if(different < DIFFERENT or law.load[0] == law.load[2] or law.load[-1] == law.load[-3], few)
    x = law.rescaled_load
    points = np.array([x, law.rescaled_friction, law.rescaled_load_sd, law.rescaled_friction_sd])
    low, high = first, last = float(x[2]), float(x[-3])
    for _ in range(GRIDS):
        kinks = np.linspace(low, high, TRIED)
        line, variance, square = bent(points, kinks)
        room = square.min() + GROWTH - square
        inside, best = np.flatnonzero(room >= 0.0), int(square.argmin())
        low, high = float(kinks[max(inside[0] - 1, 0)]), float(kinks[min(inside[-1] + 1, TRIED - 1)])
    near = np.linspace(kinks[max(best - 1, 0)], kinks[min(best + 1, TRIED - 1)], TRIED)
    lines, _, squares = bent(points, near)
    least = int(squares.argmin())
    level, *slopes = lines[least].tolist()
    spread = np.sqrt(room[inside, None] * variance[inside, 1:])
    lowest, highest = (line[inside, 1:] - spread).min(axis=0), (line[inside, 1:] + spread).max(axis=0)
    low, high = float(kinks[inside[0]]), float(kinks[inside[-1]])
    return Crossover(
        crossover_load=float(near[least]),
        crossover_friction=level,
        slopes=(slopes[0], slopes[1]),
        crossover_interval=(low, high),
        slope_intervals=((float(lowest[0]), float(highest[0])), (float(lowest[1]), float(highest[1]))),
        verdict=Verdict(float(squares[least]), count - 4),
        ambiguous=low <= first or high >= last,
    )


def bent(points: FloatArray, kink: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the level at the kink and two slopes, (b, 3), their variances, and chi-square, for b kinks.

    `points` (4, k) are loads, frictions and their standard deviations. The true load of a point is on the
    line from which the point has the smallest distance, or at the kink. A step solves the normal equations of
    York, Earth Planet. Sci. Lett. 5, 320 (1968), doi:10.1016/S0012-821X(68)80059-7, at the true loads.
    """
    x, y, sx, sy = points
    away = x - kink[:, None]  # (b, k)
    true, held = away, np.zeros(away.shape, dtype=np.bool_)
    line = np.zeros((len(kink), 3))
    for _ in range(STEPS):
        below = true <= 0.0
        # a point at the kink gives its level alone
        at_true, measured = (
            np.stack([np.ones(each.shape), each * below, each * ~below], axis=-1)
            for each in (true, np.where(held, 0.0, away))
        )
        slope = np.where(held, 0.0, np.where(below, line[:, 1, None], line[:, 2, None]))
        weight = 1.0 / (sy**2 + (slope * sx) ** 2)
        weighted = np.swapaxes(at_true * weight[..., None], -1, -2)
        line = np.linalg.solve(weighted @ measured, (weighted @ y)[..., None])[..., 0]
        squares, trues = [((away / sx) ** 2 + ((y - line[:, :1]) / sy) ** 2)], [np.zeros(away.shape)]
        for i, sign in ((1, -1.0), (2, 1.0)):
            own = line[:, i, None]
            off, spread = y - line[:, :1] - own * away, sy**2 + (own * sx) ** 2
            nearest = away + own * sx**2 * off / spread
            # a point whose nearest true load is beyond the kink does not belong to this line
            squares.append(np.where(sign * nearest >= 0.0, off**2 / spread, np.inf))
            trues.append(nearest)
        side = np.argmin(squares, axis=0)
        # a line needs two points
        enough = np.minimum((side == 1).sum(axis=1), (side == 2).sum(axis=1))[:, None] >= 2
        true, held = np.where(enough, np.choose(side, trues), true), np.where(enough, side == 0, held)
    covariance = np.linalg.inv(weighted @ at_true)
    return line, np.diagonal(covariance, axis1=-2, axis2=-1), np.min(squares, axis=0).sum(axis=-1)
