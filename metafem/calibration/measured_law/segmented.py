"""Crossover of a law with two branches, by regression with errors on both axes and by the paper's rule."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.bounded_interval import WIDTH
from metafem.calibration.measured_law.bent_line import deviations, fitted, kink_grid, least
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.calibration.verdict import Verdict, judged
from metafem.errors import refuse_if
from metafem.notes import Note, information
from metafem.prediction import BranchFit, fit_branch

# Smallest number of points: there are four parameters, and at least three points on each side of the
# crossover.
LEAST = 7

# Smallest number of different loads, equal to the number of parameters.
DIFFERENT = 4

# Growth of chi-square at the ends of a 68 % interval.
GROWTH = WIDTH**2

# Numbers of crossovers that are tried for the estimate and for the ends of its interval.
TRIED, SCANNED = 41, 201

# Number of divisions of the step that contains an end of an interval. Two rounds of division locate the end
# to within a thousandth of its distance from the estimate.
DIVISIONS = 32

# Number of steps after which an interval counts as unbounded; each step is twice as long as the previous
# step.
MOST_DOUBLINGS = 12


# Smallest number of points of a line for an estimate of the scatter.
OF_LINE = 3

# Largest deviation of a point on a line, in standard deviations. One point in twenty exceeds this deviation
# by chance.
OFF = 2.0


@dataclass(frozen=True, eq=False, repr=False)
class SegmentedFit(Value):
    """Two straight lines that meet at the crossover, fitted to a measured law.

    Attributes
    ----------
    crossover_load : float
        P/E* at which the lines meet [mm^2].
    crossover_friction : float
        Rescaled friction at the crossover [mm^2].
    slopes : (float, float)
        Slopes below and above the crossover [-].
    crossover_interval : (float, float)
        68 % interval of the crossover [mm^2].
    slope_intervals : ((float, float), (float, float))
        68 % intervals of the slopes; an end is infinite if the points do not limit the slope.
    residual : ndarray, (k,)
        Distances of the points from the lines along the friction axis, in standard deviations.
    verdict : Verdict
    notes : tuple of Note
        Notes on intervals that the points do not limit.

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


def fit_segments(law: MeasuredLaw) -> SegmentedFit:
    """Return the fit of two straight lines that meet at a crossover, with errors on both axes.

    Chi-square is the sum of the squared distances of the points from the bent line, in standard deviations
    along both axes. An interval contains the values of a parameter for which chi-square, minimised over the
    other parameters, exceeds its overall minimum by at most 0.989, the 68 % quantile of chi-square with one
    degree of freedom. If the error of the crossover is not small compared with the spacing of the points,
    several divisions of the points into two branches fit similarly well, and the intervals hold the true
    value less often: in 62 to 66 % of trials for the data of Fig. 5.

    Parameters
    ----------
    law : MeasuredLaw
        Law with at least seven points. The crossover is sought between the third load and the last but two.

    Returns
    -------
    SegmentedFit

    Raises
    ------
    InvalidInput
        If the law has fewer than seven points or fewer than four different loads.

    Notes
    -----
    The errors of load and friction are assumed to be independent.
    ``validation/calibration/segmented_regression.py`` measures the coverage for the data of Fig. 5. The
    likelihood has kinks where the crossover passes a point, so an interval from the curvature of the
    likelihood would be wrong. Because of the kinks, the crossover is found by a search over its entire range.
    Muggeo, Stat. Med. 22, 3055 (2003), doi:10.1002/sim.1545, treats the case without errors of the load.

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
    kink, level, *slopes = p[0].tolist()
    limit = float(chi_square[0]) + GROWTH
    crossover = _crossover_interval(points, kink, limit)

    def profile(side: str, values: FloatArray) -> FloatArray:
        return least(np.repeat(points, len(values), axis=1), TRIED, **{side: values})[1]

    sides = zip(("left", "right"), slopes, strict=True)
    intervals = [_interval(partial(profile, side), slope, limit) for side, slope in sides]
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
        residual=signed,
        verdict=judged(signed, parameters=4),
        notes=tuple(
            information(f"the points do not bound the {name}") for name, bound in unbound if not bound
        ),
    )


def points_of(law: MeasuredLaw) -> FloatArray:
    """Return the rescaled loads and friction of a law and their standard deviations, (4, 1, k)."""
    arrays = (law.rescaled_load, law.rescaled_friction, law.rescaled_load_sd, law.rescaled_friction_sd)
    return np.array(arrays)[:, None]


def _crossover_interval(points: FloatArray, estimate: float, limit: float) -> tuple[float, float]:
    """Return the smallest and the largest crossover whose chi-square is at most `limit`."""
    grid = np.union1d(kink_grid(points[0], SCANNED)[0], estimate)
    _, value = fitted(np.repeat(points, len(grid), axis=1), grid)
    inside = np.flatnonzero((value <= limit) | (grid == estimate))
    ends = []
    for at, step in ((int(inside[0]), -1), (int(inside[-1]), 1)):
        beyond = min(max(at + step, 0), len(grid) - 1)
        rise = value[beyond] - value[at]
        # interpolate: chi-square is nearly linear over a step of the grid
        share = max((limit - value[at]) / rise, 0.0) if rise > 0.0 else 0.0
        ends.append(float(grid[at] + share * (grid[beyond] - grid[at])))
    return ends[0], ends[1]


def _interval(profile: Callable[[Any], FloatArray], estimate: float, limit: float) -> tuple[float, float]:
    """Return the ends of the interval about an estimate, where a chi-square profile reaches `limit`."""
    ends = []
    for sign in (-1.0, 1.0):
        # evaluate the profile at steps of doubling length in one call
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


@dataclass(frozen=True)
class Branches:
    """Two straight branches of a measured law, and their crossover according to the paper's rule.

    The crossover is the midpoint between two loads: the last load on the first line and the first load off
    it. Its error is half the distance between the two loads. The rule is biased, because a point is found off
    the first line only where the two lines already differ by more than the error bars, and because a single
    large error can end the first line early. In measurements simulated with the heights of Table S2 and the
    paper's errors, the interval of this rule contains the target in only about 15 % of the trials
    (``validation/calibration/segmented_regression.py``). The intervals of `fit_segments` have the stated
    coverage.

    Attributes
    ----------
    first, second : metafem.prediction.BranchFit
        Least-squares lines with Student's 68 % intervals of their slopes and intercepts.
    crossover_load : float
        Midpoint of the two loads P/E* [mm^2].
    crossover_interval : (float, float)
        The two loads P/E* [mm^2]; not a 68 % interval.

    Examples
    --------
    >>> import metafem as mf
    >>> load = np.linspace(0.02, 0.2, 10)
    >>> area = np.where(load < 0.1, 7.0 * load, 0.7 + 12.5 * (load - 0.1))
    >>> law = MeasuredLaw(load, area=area, load_sd=np.full(10, 1e-3), material=mf.Material(1.0))
    >>> found = branches(law)
    >>> round(found.first.slope, 2), round(found.second.slope, 2), round(found.crossover_load, 3)
    (7.0, 12.5, 0.11)
    """

    first: BranchFit
    second: BranchFit
    crossover_load: float
    crossover_interval: tuple[float, float]


def branches(law: MeasuredLaw, first: int | None = None, second: int | None = None) -> Branches:
    """Return lines through the first and the last points of a law, and their crossover by the paper's rule.

    If `first` is None, the first line begins with three points. The next point is added as long as it
    deviates from the line by at most twice its error bar. Aymard et al., Science 383, 200 (2024),
    doi:10.1126/science.adk4234, Fig. 5 and supplementary text on friction laws with two branches.

    Parameters
    ----------
    law : MeasuredLaw
    first, second : int, optional
        Numbers of points of the first and the last line, at least 3. Default: the first line ends before the
        first point that deviates from it, and the last line has all following points, at least 3.

    Returns
    -------
    Branches

    Raises
    ------
    InvalidInput
        If the law has fewer than six points, or if no point deviates from the first line, so that there is
        only one branch.

    Examples
    --------
    >>> import metafem as mf
    >>> load = np.linspace(0.02, 0.2, 10)
    >>> area = np.where(load < 0.1, 7.0 * load, 0.7 + 12.5 * (load - 0.1))
    >>> law = MeasuredLaw(load, area=area, load_sd=np.full(10, 1e-3), material=mf.Material(1.0))
    >>> np.round(branches(law, first=5).crossover_interval, 3)
    array([0.1 , 0.12])
    """
    check.instance("law", law, MeasuredLaw, "a metafem.calibration.MeasuredLaw")
    law = law.known()
    count = len(law.load)
    refuse_if(count < 2 * OF_LINE, f"law has {count} points; two branches need at least {2 * OF_LINE}")
    number = OF_LINE if first is None else check.integer("first", first, at_least=OF_LINE)
    refuse_if(number >= count, f"first = {number} leaves none of the {count} points for a second branch")
    while first is None and number < count and not _off(law, _line(law, 0, number))[number]:
        number += 1
    line = _line(law, 0, number)
    off = number + np.flatnonzero(_off(law, line)[number:])
    refuse_if(
        not off.size,
        "no point is off the first line by more than twice its error bar: the law has one branch; "
        "use law.fit",
    )
    last = int(off[0]) - 1
    behind = count - 1 - last if second is None else check.integer("second", second, at_least=OF_LINE)
    refuse_if(behind > count, f"second = {behind} exceeds the {count} points of the law")
    ends = float(law.rescaled_load[last]), float(law.rescaled_load[last + 1])
    return Branches(line, _line(law, count - max(behind, OF_LINE), count), 0.5 * sum(ends), ends)


def _line(law: MeasuredLaw, start: int, stop: int) -> BranchFit:
    """Return the least-squares line through the consecutive points `start` to `stop`."""
    x, y = law.rescaled_load[start:stop], law.rescaled_friction[start:stop]
    one = f"the points {start + 1} to {stop} have one load; a line needs different loads"
    refuse_if(np.ptp(x) == 0.0, one)
    return fit_branch(x, y, (float(x[0]), float(x[-1])), law.material, law.friction)


def _off(law: MeasuredLaw, line: BranchFit) -> np.ndarray:
    """Return which points deviate from a line by more than twice their error bars of both axes, (k,)."""
    deviation = law.rescaled_friction - line.intercept - line.slope * law.rescaled_load
    spread = np.hypot(law.rescaled_friction_sd, line.slope * law.rescaled_load_sd)
    return np.asarray(np.abs(deviation) > OFF * spread)
