"""Two branches and their crossover with 68 % intervals: regression with errors on both axes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.measured_law.bent_line import (
    KINK,
    LEFT,
    LEVEL,
    RIGHT,
    Points,
    deviations,
    fitted,
    growths,
    kink_grid,
    least,
)
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.calibration.verdict import Verdict, judged
from metafem.errors import InvalidInput
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
    slopes: tuple[float, float]
    crossover_interval: tuple[float, float]
    slope_intervals: tuple[tuple[float, float], tuple[float, float]]
    growth: tuple[float, float, float]
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
    if len(law.load) < LEAST:
        raise InvalidInput(f"law has {len(law.load)} points; two lines that meet need at least {LEAST}")
    points = points_of(law)
    different = len(np.unique(points.x))
    if different < DIFFERENT:
        raise InvalidInput(f"law has {different} different loads; two lines that meet need {DIFFERENT}")
    best = least(points, TRIED)
    p, chi_square = best.parameters, float(best.chi_square[0])
    growth = growths(points, p, count, generator)[:, 0]
    notes: list[Note] = []
    crossover = _crossover_interval(points, float(p[0, KINK]), chi_square + growth[0])
    if crossover[0] <= points.x[0, 2] or crossover[1] >= points.x[0, -3]:
        notes.append(
            information(
                "the points do not bound the crossover: its interval ends at the third load from an end"
            )
        )
    slopes = []
    for index, name, limit in ((LEFT, "left", growth[1]), (RIGHT, "right", growth[2])):

        def profile(values: FloatArray, name: str = name) -> FloatArray:
            many = points.take(np.zeros(len(values), dtype=int))
            return least(many, TRIED, **{name: values}).chi_square

        interval = _interval(profile, float(p[0, index]), chi_square + limit)
        if not np.isfinite(interval).all():
            which = "below" if index == LEFT else "above"
            notes.append(information(f"the points do not bound the slope {which} the crossover"))
        slopes.append(interval)
    residual = deviations(points, p)[0][0]
    along_x = deviations(points, p)[1][0]
    signed = np.sign(residual) * np.hypot(residual, along_x)
    return SegmentedFit(
        crossover_load=float(p[0, KINK]),
        crossover_friction=float(p[0, LEVEL]),
        slopes=(float(p[0, LEFT]), float(p[0, RIGHT])),
        crossover_interval=crossover,
        slope_intervals=(slopes[0], slopes[1]),
        growth=(float(growth[0]), float(growth[1]), float(growth[2])),
        residual=signed,
        verdict=judged(signed, parameters=4),
        notes=tuple(notes),
    )


def points_of(law: MeasuredLaw) -> Points:
    """Return the rescaled points of a law, as one of many."""
    arrays = (law.rescaled_load, law.rescaled_friction, law.rescaled_load_sd, law.rescaled_friction_sd)
    return Points(*(values[None] for values in arrays))


def _crossover_interval(points: Points, estimate: float, limit: float) -> tuple[float, float]:
    """Return the outermost crossovers whose chi-square is at most a limit."""
    grid = np.union1d(kink_grid(points.x, SCANNED)[0], estimate)
    value = fitted(points.take(np.zeros(len(grid), dtype=int)), grid).chi_square
    inside = np.flatnonzero((value <= limit) | (grid == estimate))
    first, last = int(inside[0]), int(inside[-1])
    ends = []
    for at, beyond in ((first, first - 1), (last, last + 1)):
        if 0 <= beyond < len(grid):  # chi-square is nearly linear over a step of the grid
            share = (limit - value[at]) / (value[beyond] - value[at])
            ends.append(float(grid[at] + max(share, 0.0) * (grid[beyond] - grid[at])))
        else:
            ends.append(float(grid[at]))
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
