"""Straight lines fitted to the branches of a friction law."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import stdtrit

from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.surface import Friction, Material

# Probability of values below the upper end of a two-sided 68 % interval of Student's distribution.
UPPER = 0.84


@dataclass(frozen=True)
class BranchFit:
    """Straight line fitted to a branch of a law, rescaled friction over rescaled load.

    Attributes
    ----------
    slope : float
        Slope m [-]; the friction coefficient is about ``sigma B / E* m``.
    intercept : float
        Rescaled friction at zero load [mm^2].
    slope_interval, intercept_interval : (float, float)
        68 % confidence intervals from the regression.
    load_range : (float, float)
        Range of the rescaled loads of the fitted points [mm^2].
    points : int
        Number of points.
    friction_coefficient, friction_coefficient_interval : float and (float, float), or None
        ``dF/dP = sigma B / E* m`` [-] and its 68 % interval; None for a surface without a Friction.
    intercept_force, intercept_force_interval : float and (float, float), or None
        Friction force at zero load [N] and its 68 % interval; None for a surface without a Friction.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice(0.1, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> fit = mf.friction_law(surface, load=np.linspace(0.1, 0.2, 11)).fit(load=(0.1, 0.2))
    >>> round(fit.slope, 2), round(fit.intercept, 2), fit.points, fit.friction_coefficient
    (3.75, 0.2, 11, None)
    """

    slope: float
    intercept: float
    slope_interval: tuple[float, float]
    intercept_interval: tuple[float, float]
    load_range: tuple[float, float]
    points: int
    friction_coefficient: float | None = None
    friction_coefficient_interval: tuple[float, float] | None = None
    intercept_force: float | None = None
    intercept_force_interval: tuple[float, float] | None = None


def fit_branch(
    load: FloatArray,
    area: FloatArray,
    load_range: tuple[float, float],
    material: Material,
    friction: Friction | None,
) -> BranchFit:
    """Return the least-squares line of rescaled friction over rescaled loads (k,) [mm^2], between two."""
    low, high = load_range
    refuse_if(high <= low, f"load_range = ({low:g}, {high:g}) must increase")
    chosen = (load >= low) & (load <= high) & ~np.isnan(area)  # areas of a measured law may be unknown
    count = int(chosen.sum())
    refuse_if(
        count < 3 or np.ptp(load[chosen]) == 0.0,
        f"load_range = ({low:g}, {high:g}) holds {count} of the law's points, which run from "
        f"{load.min():g} to {load.max():g} mm^2; a fit needs at least 3 points, "
        "at different loads",
    )
    x, y = load[chosen], area[chosen]
    centre, spread = x.mean(), ((x - x.mean()) ** 2).sum()
    slope = float(((x - centre) * (y - y.mean())).sum() / spread)
    intercept = float(y.mean() - slope * centre)
    variance = float(((y - intercept - slope * x) ** 2).sum()) / (count - 2)
    student = float(stdtrit(count - 2, UPPER))
    slope_error = student * math.sqrt(variance / spread)
    intercept_error = student * math.sqrt(variance * (1.0 / count + centre**2 / spread))
    slopes = slope - slope_error, slope + slope_error
    intercepts = intercept - intercept_error, intercept + intercept_error
    fit = BranchFit(slope, intercept, slopes, intercepts, (low, high), count)
    if friction is None:
        return fit
    stress = friction.stress
    per_slope = stress / material.composite_modulus
    return replace(
        fit,
        friction_coefficient=per_slope * slope,
        friction_coefficient_interval=(per_slope * slopes[0], per_slope * slopes[1]),
        intercept_force=stress * intercept,
        intercept_force_interval=(stress * intercepts[0], stress * intercepts[1]),
    )
