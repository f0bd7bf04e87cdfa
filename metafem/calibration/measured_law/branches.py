"""Two straight branches and their crossover by the paper's rule."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem.calibration.measured_law.law import MeasuredLaw
from metafem.errors import refuse_if
from metafem.prediction import BranchFit, fit_branch

# Fewest points of a line whose scatter can be judged.
LEAST = 3

# Largest deviation of a point on a line, in standard deviations: one point in twenty exceeds it by chance.
OFF = 2.0


@dataclass(frozen=True)
class Branches:
    """Two straight branches of a measured law, with the crossover by the paper's rule.

    The crossover is the middle between the last point on the first line and the first point off it, and its
    error half their distance. It is biased: a point is found off the first line only where the two lines
    already differ by more than the error bars, and a single error can end the first line early. Of
    measurements simulated with the heights of Table S2 and the paper's errors, the stated interval contains
    the target in about 15 % of the trials (``validation/calibration/segmented_regression.py``). The interval
    of `fit_segments` has the stated coverage.

    Attributes
    ----------
    first, second : metafem.prediction.BranchFit
        Least-squares lines with Student's 68 % intervals of their slopes and intercepts.
    crossover_load : float
        Middle of the two loads P/E* [mm^2].
    crossover_interval : (float, float)
        The two loads [mm^2]: the paper's rule, not a 68 % interval.

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
    """Fit lines to the first and to the last points of a law, and state the crossover by the paper's rule.

    Without `first`, the first line begins with three points. The next point is added as long as it deviates
    from the line by at most twice its error bar. Aymard et al., Science 383, 200 (2024),
    doi:10.1126/science.adk4234, Fig. 5 and supplementary text on friction laws with two branches.

    Parameters
    ----------
    law : MeasuredLaw
    first, second : int, optional
        Numbers of points of the first and of the last line, at least 3. Default: the first line ends before
        the first point off it, and the last line has all following points, at least 3.

    Returns
    -------
    Branches

    Raises
    ------
    InvalidInput
        If the law has fewer than six points, or only one branch because no point is off the first line.

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
    refuse_if(count < 2 * LEAST, f"law has {count} points; two branches need at least {2 * LEAST}")
    number = LEAST if first is None else check.integer("first", first, at_least=LEAST)
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
    behind = count - 1 - last if second is None else check.integer("second", second, at_least=LEAST)
    refuse_if(behind > count, f"second = {behind} exceeds the {count} points of the law")
    ends = float(law.rescaled_load[last]), float(law.rescaled_load[last + 1])
    return Branches(line, _line(law, count - max(behind, LEAST), count), 0.5 * sum(ends), ends)


def _line(law: MeasuredLaw, start: int, stop: int) -> BranchFit:
    """Return the least-squares line of consecutive points."""
    x, y = law.rescaled_load[start:stop], law.rescaled_friction[start:stop]
    one = f"the points {start + 1} to {stop} have one load; a line needs different loads"
    refuse_if(np.ptp(x) == 0.0, one)
    return fit_branch(x, y, (float(x[0]), float(x[-1])), law.material, law.friction)


def _off(law: MeasuredLaw, line: BranchFit) -> np.ndarray:
    """Return which points are off a line by more than their error bars on both axes."""
    deviation = law.rescaled_friction - line.intercept - line.slope * law.rescaled_load
    spread = np.hypot(law.rescaled_friction_sd, line.slope * law.rescaled_load_sd)
    return np.asarray(np.abs(deviation) > OFF * spread)
