"""Two branches and their crossover with 68 % intervals: regression with errors on both axes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.measured_law.bent_line import (
    deviations,
    fitted,
    growths,
    kink_grid,
    least,
)
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.calibration.verdict import Verdict, judged
from metafem.errors import refuse_if
from metafem.notes import Note, information

# Fewest points: four parameters, three points on each side of the crossover.
LEAST = 7

# Fewest different loads: as many as parameters.
DIFFERENT = 4

# Numbers of crossovers that are tried: for the estimate, and for the ends of its interval.
TRIED, SCANNED = 41, 201

# Divisions of the step that contains an end of an interval. Two rounds locate the end to a thousandth of its
# distance from the estimate.
DIVISIONS = 32

# Number of steps, each twice as long as the last, after which an interval counts as unbounded.
MOST_DOUBLINGS = 12


@dataclass(frozen=True, eq=False, repr=False)
class SegmentedFit(Value):
    """Two straight lines that meet at the crossover, fitted to a measured law.

    Attributes
    ----------
    crossover_load : float
        P/E* at which the lines meet [mm^2].
    crossover_friction : float
        Rescaled friction there [mm^2].
    slopes : (float, float)
        Slopes below and above the crossover [-].
    crossover_interval : (float, float)
        68 % interval of the crossover [mm^2].
    slope_intervals : ((float, float), (float, float))
        68 % intervals of the slopes; an end is infinite where the points do not bound the slope.
    growth : (float, float, float)
        Growth of chi-square at the ends of the intervals of the crossover and of the two slopes; 0.989 for
        many points or small errors.
    residual : ndarray, (k,)
        Distances of the points from the lines along the axis of the friction, in standard deviations.
    verdict : Verdict
    notes : tuple of Note
        Intervals that the points do not bound.

    Examples
    --------
    >>> import metafem as mf
    >>> load = np.linspace(0.02, 0.2, 10)
    >>> area = np.where(load < 0.1, 7.0 * load, 0.7 + 12.5 * (load - 0.1))
    >>> law = MeasuredLaw(load, area=area, load_sd=np.full(10, 1e-3), material=mf.Material(1.0))
    >>> fit_segments(law)
    <SegmentedFit: slopes 7 (6.83 to 7.12) and 12.5 (12.3 to 12.7), crossover 0.1 (0.0976 to 0.103) mm^2>
    """

    crossover_load: float
    crossover_friction: float
    slopes: tuple[float, ...]
    crossover_interval: tuple[float, float]
    slope_intervals: tuple[tuple[float, float], ...]
    growth: tuple[float, ...]
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
            f"<SegmentedFit: slopes {slopes}, crossover {self.crossover_load:.3g} "
            f"({low:.3g} to {high:.3g}) mm^2>"
        )


def fit_segments(law: MeasuredLaw, *, draws: int = 2000, rng: Any = 0) -> SegmentedFit:
    """Fit two straight lines that meet at a crossover, with errors on both axes.

    Chi-square is the sum of the squared distances of the points from the bent line in standard deviations,
    along both axes. An interval contains the values of a parameter for which chi-square, minimised over the
    others, exceeds its minimum by at most q. For many points or small errors, q is the 68 % quantile of
    chi-square with one degree of freedom, 0.989. If the error of the crossover is not small compared with the
    distance of the points, several splits of the points into two branches fit similarly well, and intervals
    with this q cover 62 to 68 % for the data of Fig. 5. q is therefore the 68 % quantile of the growth of
    chi-square in simulated laws on the fitted lines.

    Parameters
    ----------
    law : MeasuredLaw
        At least seven points. The crossover is sought between the third and the last but two loads.
    draws : int
        Number of simulated laws, at least 100; default: 2,000.
    rng : int or numpy.random.Generator
        Seed or generator; default: 0.

    Returns
    -------
    SegmentedFit

    Raises
    ------
    InvalidInput
        For fewer than seven points or four different loads.

    Notes
    -----
    The errors of load and friction are independent. Coverage for the data of Fig. 5 is measured by
    ``validation/calibration/segmented_regression.py``. The likelihood has kinks where the crossover passes a
    point, so that an interval from its curvature would be wrong; the crossover is found by a search over its
    whole range. Muggeo, Stat. Med. 22, 3055 (2003), doi:10.1002/sim.1545, treats the case without errors of
    the load.

    Examples
    --------
    >>> import metafem as mf
    >>> load = np.linspace(0.02, 0.2, 10)
    >>> area = np.where(load < 0.1, 7.0 * load, 0.7 + 12.5 * (load - 0.1))
    >>> law = MeasuredLaw(load, area=area, load_sd=np.full(10, 1e-3), material=mf.Material(1.0))
    >>> found = fit_segments(law)
    >>> np.round(found.slopes, 2), round(found.crossover_load, 4)
    (array([ 7. , 12.5]), 0.1)
    """
    check.instance("law", law, MeasuredLaw, "a metafem.calibration.MeasuredLaw")
    law = law.known()
    count = check.integer("draws", draws, at_least=100)
    generator = check.generator(rng)
    few = len(law.load)
    refuse_if(few < LEAST, f"law has {few} points; two lines that meet need at least {LEAST}")
    points = points_of(law)
    x = points[0, 0]
    different = len(np.unique(x))
    refuse_if(
        different < DIFFERENT,
        f"law has {different} different loads; two lines that meet need {DIFFERENT}",
    )
    p, chi_square = least(points, TRIED)
    growth = growths(points, p, count, generator)[:, 0]
    kink, level, *slopes = p[0].tolist()
    limit, *limits = (chi_square[0] + growth).tolist()
    crossover = _crossover_interval(points, kink, limit)

    def profile(side: str, values: FloatArray) -> FloatArray:
        return least(np.repeat(points, len(values), axis=1), TRIED, **{side: values})[1]

    sides = zip(("left", "right"), slopes, limits, strict=True)
    intervals = [_interval(partial(profile, side), *ends) for side, *ends in sides]
    unbound = [
        (
            "crossover: its interval ends at the third load from an end",
            crossover[0] > x[2] and crossover[1] < x[-3],
        ),
        ("slope below the crossover", np.isfinite(intervals[0]).all()),
        ("slope above the crossover", np.isfinite(intervals[1]).all()),
    ]
    along_y, along_x, _ = deviations(points, p)
    signed = (np.sign(along_y) * np.hypot(along_y, along_x))[0]
    return SegmentedFit(
        crossover_load=kink,
        crossover_friction=level,
        slopes=tuple(slopes),
        crossover_interval=crossover,
        slope_intervals=tuple(intervals),
        growth=tuple(growth.tolist()),
        residual=signed,
        verdict=judged(signed, parameters=4),
        notes=tuple(
            information(f"the points do not bound the {name}") for name, bound in unbound if not bound
        ),
    )


def points_of(law: MeasuredLaw) -> FloatArray:
    """Return the rescaled points of a law and their standard deviations, (4, 1, k)."""
    arrays = (law.rescaled_load, law.rescaled_friction, law.rescaled_load_sd, law.rescaled_friction_sd)
    return np.array(arrays)[:, None]


def _crossover_interval(points: FloatArray, estimate: float, limit: float) -> tuple[float, float]:
    """Return the outermost crossovers whose chi-square is at most a limit."""
    grid = np.union1d(kink_grid(points[0], SCANNED)[0], estimate)
    _, value = fitted(np.repeat(points, len(grid), axis=1), grid)
    inside = np.flatnonzero((value <= limit) | (grid == estimate))
    ends = []
    for at, step in ((int(inside[0]), -1), (int(inside[-1]), 1)):
        beyond = min(max(at + step, 0), len(grid) - 1)
        rise = value[beyond] - value[at]
        # chi-square is nearly linear over a step of the grid
        share = max((limit - value[at]) / rise, 0.0) if rise > 0.0 else 0.0
        ends.append(float(grid[at] + share * (grid[beyond] - grid[at])))
    return ends[0], ends[1]


def _interval(profile: Callable[[Any], FloatArray], estimate: float, limit: float) -> tuple[float, float]:
    """Return the ends of an interval about an estimate at which a profile reaches a limit."""
    ends = []
    for sign in (-1.0, 1.0):
        # the profile at steps of doubling length, computed together
        steps = sign * 0.02 * abs(estimate) * 2.0 ** np.arange(MOST_DOUBLINGS)
        value = profile(estimate + steps)
        above = np.flatnonzero(value > limit)
        if not above.size:
            ends.append(sign * np.inf)
            continue
        outer = int(above[0])
        inside, outside = (0.0 if outer == 0 else steps[outer - 1]), steps[outer]
        for _ in range(2):
            tried = np.linspace(inside, outside, DIVISIONS + 1)
            place = int(np.argmax(np.append(profile(estimate + tried[1:-1]) > limit, True)))
            inside, outside = tried[place], tried[place + 1]
        ends.append(float(estimate + 0.5 * (inside + outside)))
    return ends[0], ends[1]
