"""Crossover of a measured law with two branches, by a fit of two lines with errors on both axes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.calibration import errors_in_variables as variables
from metafem.calibration.laws import MeasuredLaw
from metafem.calibration.statistics import WIDTH, Verdict, judged
from metafem.errors import refuse_if

# Smallest number of points, four parameters and at least three points on each side of the crossover, and
# smallest number of different loads.
FEWEST, DIFFERENT = 7, 4

# Growth of chi-square at the ends of a 68 % interval.
GROWTH = WIDTH**2

# Number of crossovers of a grid, and number of grids, of which each covers the interval that the one before
# finds: two find its ends to a hundredth of its length.
TRIED, GRIDS = 101, 2

# Error of the crossover over the range of the loads.
ROUNDING = 1e-6

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
    residual: FloatArray
    ambiguous: bool

    @property
    def verdict(self) -> Verdict:
        """Whether two lines fit the points."""
        return judged(self.residual, parameters=4)

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
    x, y = law.rescaled_load, law.rescaled_friction
    points = np.array([x, y, law.rescaled_load_sd, law.rescaled_friction_sd])
    first, last = float(x[2]), float(x[-3])
    low, high = first, last
    for _ in range(GRIDS):  # the last grid covers the interval of the one before
        kinks = np.linspace(low, high, TRIED)
        fit = bent(points, kinks)
        square = fit.chi_square.sum(axis=-1)
        room = square.min() + GROWTH - square
        inside = np.flatnonzero(room >= 0.0)
        low, high = float(kinks[max(inside[0] - 1, 0)]), float(kinks[min(inside[-1] + 1, TRIED - 1)])
    best = int(square.argmin())
    found = minimize_scalar(
        lambda kink: bent(points, np.array([kink])).chi_square.sum(),
        bounds=kinks[[max(best - 1, 0), min(best + 1, TRIED - 1)]],
        method="bounded",
        options={"xatol": ROUNDING * (last - first)},
    )
    own = bent(points, np.array([found.x]))
    kink, (level, below, above) = float(found.x), own.parameter[0].tolist()
    slope, variance = fit.parameter[inside, 1:], np.diagonal(fit.covariance, axis1=-2, axis2=-1)[inside, 1:]
    spread = np.sqrt(room[inside, None] * variance)
    ends = (slope - spread).min(axis=0).tolist(), (slope + spread).max(axis=0).tolist()
    off = y - level - np.where(x <= kink, below, above) * (x - kink)
    interval = float(kinks[inside[0]]), float(kinks[inside[-1]])
    return Crossover(
        crossover_load=float(found.x),
        crossover_friction=level,
        slopes=(below, above),
        crossover_interval=interval,
        slope_intervals=((ends[0][0], ends[1][0]), (ends[0][1], ends[1][1])),
        residual=np.sign(off) * np.sqrt(own.chi_square[0]),
        ambiguous=interval[0] <= first or interval[1] >= last,
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
