"""Crossover of a measured law with two branches, by a fit of two lines with errors on both axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.calibration import errors_in_variables as variables
from metafem.calibration.laws import MeasuredLaw
from metafem.calibration.statistics import WIDTH, Verdict, judged
from metafem.errors import refuse_if
from metafem.notes import Note, information

# Smallest number of points, four parameters and at least three points on each side of the crossover, and
# smallest number of different loads.
FEWEST, DIFFERENT = 7, 4

# Growth of chi-square at the ends of a 68 % interval.
GROWTH = WIDTH**2

# Number of crossovers of a grid, and number of grids, each between the neighbours of the best of the one
# before: four grids find a crossover to a hundred-thousandth of the range.
TRIED, GRIDS = 81, 4

# Sides of a point, beside 0 for a point at the kink, and number of fits between which sides may change.
LEFT, RIGHT, ROUNDS = 1, 2, 3


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
    residual : ndarray, (k,)
        Distances of the points from the lines in standard deviations, with the sign of the friction.
    verdict : Verdict
    notes : tuple of Note
        Note on a crossover that the points do not limit.

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
    residual: FloatArray
    verdict: Verdict
    notes: tuple[Note, ...] = ()

    def __repr__(self) -> str:
        slopes = " and ".join(
            f"{slope:.3g} ({low:.3g} to {high:.3g})"
            for slope, (low, high) in zip(self.slopes, self.slope_intervals, strict=True)
        )
        low, high = self.crossover_interval
        return (
            f"<Crossover: slopes {slopes}, crossover {self.crossover_load:.3g} "
            f"({low:.3g} to {high:.3g}) mm^2>"
        )


def crossover(law: MeasuredLaw) -> Crossover:
    """Return the fit of two straight lines that meet at a crossover, with errors on both axes.

    Chi-square is minimised over the lines and the true loads for each crossover of a grid between the third
    load and the last but two. The interval of the crossover holds those whose chi-square exceeds the minimum
    by at most 0.989, the 68 % quantile of chi-square with one degree of freedom, and the interval of a slope
    the slopes for which this is so at any crossover. If the error of the crossover is not small compared with
    the spacing of the points, several divisions of the points into two branches fit similarly well, and the
    intervals hold the true value less often: in 61 to 66 % of trials for the data of Fig. 5 of Aymard et al.,
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
    law = law.known()
    count, different = len(law.load), len(np.unique(law.load))
    refuse_if(count < FEWEST, f"law has {count} points; two lines that meet need at least {FEWEST}")
    few = f"law has {different} different loads; two lines that meet need {DIFFERENT}"
    refuse_if(different < DIFFERENT or law.load[0] == law.load[2] or law.load[-1] == law.load[-3], few)
    points = np.array(
        [law.rescaled_load, law.rescaled_friction, law.rescaled_load_sd, law.rescaled_friction_sd]
    )
    kinks = np.linspace(points[0, 2], points[0, -3], TRIED)
    fit = bent(points, kinks)
    square = fit.chi_square.sum(axis=-1)
    limit, place = float(square.min()) + GROWTH, int(square.argmin())
    best, own = kinks, fit
    for _ in range(GRIDS - 1):
        best = np.linspace(best[max(place - 1, 0)], best[min(place + 1, TRIED - 1)], TRIED)
        own = bent(points, best)
        place = int(own.chi_square.sum(axis=-1).argmin())
    limit = min(limit, float(own.chi_square[place].sum()) + GROWTH)
    level, *slopes = own.parameter[place].tolist()
    interval = _within(kinks, square, limit, float(best[place]))
    bounds = _slopes(fit, limit - square), _slopes(own, limit - own.chi_square.sum(axis=-1))
    lows, highs = (pick([ends[i] for ends in bounds], axis=0) for i, pick in enumerate((np.min, np.max)))
    off = points[1] - level - np.where(points[0] <= best[place], *slopes) * (points[0] - best[place])
    residual = np.sign(off) * np.sqrt(own.chi_square[place])
    bound = interval[0] > kinks[0] and interval[1] < kinks[-1]
    text = "the points do not bound the crossover: its interval ends at the third load from an end"
    return Crossover(
        crossover_load=float(best[place]),
        crossover_friction=level,
        slopes=(slopes[0], slopes[1]),
        crossover_interval=interval,
        slope_intervals=((lows[0], highs[0]), (lows[1], highs[1])),
        residual=residual,
        verdict=judged(residual, parameters=4),
        notes=() if bound else (information(text),),
    )


def bent(points: FloatArray, kink: FloatArray) -> variables.Fit:
    """Return fits of the level at the kink and of two slopes for kinks (b,), to points (4, k) of one law.

    The points are loads, frictions and their standard deviations. The true load of a point is on the line
    from which the point has the smallest distance, or at the kink.
    """
    x, y, sx, sy = (np.broadcast_to(each, (len(kink), each.shape[-1])) for each in points)
    measured, sd = np.stack([x, y], axis=-1), np.stack([sx, sy], axis=-1)
    away = x - kink[:, None]
    side = np.where(away <= 0.0, LEFT, RIGHT)
    fit = _of_sides(measured, sd, kink, side, None)
    for _ in range(ROUNDS - 1):
        level, low, high = (fit.parameter[:, i, None] for i in range(3))
        square = [(away / sx) ** 2 + ((y - level) / sy) ** 2]
        for slope, sign in ((low, -1.0), (high, 1.0)):
            off, spread = y - level - slope * away, sy**2 + (slope * sx) ** 2
            # a point whose nearest true load is beyond the kink does not belong to this line
            there = sign * (away + slope * sx**2 * off / spread) >= 0.0
            square.append(np.where(there, off**2 / spread, np.inf))
        nearest = np.argmin(square, axis=0)
        # a line needs two points
        enough = np.minimum(*((nearest == each).sum(axis=1) for each in (LEFT, RIGHT))) >= 2
        side = np.where(enough[:, None], nearest, side)
        fit = _of_sides(measured, sd, kink, side, fit)
    return fit


def _of_sides(
    measured: FloatArray, sd: FloatArray, kink: FloatArray, side: IntArray, guess: variables.Fit | None
) -> variables.Fit:
    """Return fits to points (b, k, 2) that are at the kink, on the left or on the right line."""
    at_kink, at = side == 0, kink[:, None]

    def model(p: FloatArray, xi: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        slope = np.where(at_kink, 0.0, np.where(side == LEFT, p[:, 1, None], p[:, 2, None]))
        load = np.where(at_kink, at, xi[..., 0])
        value = np.stack([load, p[:, :1] + slope * (load - at)], axis=-1)
        parts = [np.ones(load.shape), *(np.where(side == each, load - at, 0.0) for each in (LEFT, RIGHT))]
        by_p = np.stack([np.zeros((*load.shape, 3)), np.stack(parts, axis=-1)], axis=-2)
        return value, by_p, np.stack([~at_kink, slope], axis=-1)[..., None]

    start = (
        (np.zeros((len(kink), 3)), measured[..., :1]) if guess is None else (guess.parameter, guess.abscissa)
    )
    return variables.fit(model, measured, lambda _: sd, *start)


def _within(grid: FloatArray, value: FloatArray, limit: float, estimate: float) -> tuple[float, float]:
    """Return the smallest and the largest crossover whose chi-square is at most `limit`."""
    inside = np.flatnonzero(value <= limit)
    if not inside.size:
        return estimate, estimate
    ends = []
    for at, step in ((int(inside[0]), -1), (int(inside[-1]), 1)):
        beyond = min(max(at + step, 0), len(grid) - 1)
        rise = value[beyond] - value[at]
        # interpolate: chi-square is nearly linear over a step of the grid
        share = max((limit - value[at]) / rise, 0.0) if rise > 0.0 else 0.0
        ends.append(float(grid[at] + share * (grid[beyond] - grid[at])))
    return min(ends[0], estimate), max(ends[1], estimate)


def _slopes(fit: variables.Fit, left: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the smallest and the largest slopes (2,), where chi-square may grow by `left` at each kink."""
    room = np.sqrt(np.maximum(left, 0.0))[:, None]
    inside = (left >= 0.0)[:, None]
    slope, sd = fit.parameter[:, 1:], np.sqrt(np.einsum("kii->ki", fit.covariance)[:, 1:])
    low = np.where(inside, slope - room * sd, np.inf).min(axis=0)
    return low, np.where(inside, slope + room * sd, -np.inf).max(axis=0)
