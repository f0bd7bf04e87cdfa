"""Bounds on the friction of every surface of N asperities of one radius, independent of each other.

At a load p = P/E*, ``sum d^(3/2)`` is given and A0 = pi R sum d lies between that of one contact and that
of N equal ones. Along a law, ``dA0/dp = (pi sqrt(R)/2) / <sqrt d>`` with the mean over the contacts, and
Cauchy's inequality between the sums of d^(1/2), d and d^(3/2) bounds it by A0 and p alone.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import Infeasible
from metafem.inversion.bounds import common_radius
from metafem.inversion.limits import Limits
from metafem.inversion.target import MultilinearLaw, PowerLaw, SampledLaw
from metafem.surface import Surface

# A value this close to a bound is on it: rounding must not refuse what a surface was read off.
ROUNDING = 1e-9

# Exponent of a fixed set of equal contacts, the least of any surface.
LEAST_EXPONENT = 2.0 / 3.0


def friction_bounds(load: FloatArray, radius: float, count: int) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest friction at rescaled loads, (k,) [mm^2]: one contact, and N equal."""
    low = math.pi * radius * (0.75 * load / math.sqrt(radius)) ** LEAST_EXPONENT
    return low, low * count ** (1.0 / 3.0)


def slope_bounds(load: float, friction: float, radius: float, count: int) -> tuple[float, float]:
    """Return the flattest and steepest slope at a point of a law [-]: 2/3 A0/p, and N contacts at once."""
    steepest = 0.5 * math.pi * math.sqrt(radius) * count
    steepest *= 0.75 * load / math.sqrt(radius) / (friction / (math.pi * radius)) ** 2
    return LEAST_EXPONENT * friction / load, steepest


def largest_exponent(load_range: tuple[float, float], count: int) -> float:
    """Return the largest exponent over a range of loads, ``2/3 + ln N^(1/3) / ln(P2/P1)``."""
    low, high = load_range
    return LEAST_EXPONENT + math.log(count) / 3.0 / math.log(high / low)


def largest_load(radius: float, count: int, limits: Limits) -> float:
    """Return the load P/E* [mm^2] that N asperities carry when the plane reaches the base plane."""
    depth = limits.offset + limits.max_height
    return 4.0 / 3.0 * count * math.sqrt(radius * depth) * depth


def feasible_region(
    template: Surface, rescaled_load: ArrayLike, limits: Limits
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest friction that any surface can have at each load.

    ``pi R (3p/(4 sqrt R))^(2/3)`` and that times ``N^(1/3)``, for independent asperities of one radius;
    nan beyond the load at which N summits of the largest height have the plane at the base plane.

    Parameters
    ----------
    template : Surface
        With one common radius R; its places count N.
    rescaled_load : array_like, (k,)
        P/E* [mm^2], positive.
    limits : Limits

    Returns
    -------
    low, high : ndarray, (k,)
        F/(sigma B) [mm^2].

    Raises
    ------
    InvalidInput
        For loads that are not positive, or several radii.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> low, high = feasible_region(template, [0.1, 0.4], Limits(0.12))
    >>> (high / low).round(12)
    array([4., 4.])
    """
    check.instance("template", template, Surface, "a metafem.Surface")
    check.instance("limits", limits, Limits, "metafem.Limits")
    load = check.array("rescaled_load", rescaled_load, shape=(None,))
    if load.min() <= 0.0:
        check.number("rescaled_load", float(load.min()), above=0.0)
    radius = common_radius(template)
    low, high = friction_bounds(load, radius, template.count)
    beyond = load > largest_load(radius, template.count, limits)
    return np.where(beyond, np.nan, low), np.where(beyond, np.nan, high)


def refuse_sampled(target: SampledLaw, radius: float, count: int, limits: Limits, margin: float) -> None:
    """Raise Infeasible for samples that break a bound by more than a margin (relative)."""
    load, friction = target.rescaled_load, target.rescaled_friction
    refuse_load(float(load[-1]), radius, count, limits)
    low, high = friction_bounds(load, radius, count)
    slack = margin + ROUNDING
    scaled = friction / load**LEAST_EXPONENT
    top = np.maximum.accumulate(scaled)
    for broken, words, bound in (
        (friction < low * (1.0 - slack), "below that of a single asperity", low),
        (friction > high * (1.0 + slack), f"above that of {count} equal asperities", high),
        (
            scaled < top * (1.0 - slack),
            "below what the asperities of the smaller loads already give (F/P^(2/3) cannot fall)",
            top * load**LEAST_EXPONENT,
        ),
    ):
        if broken.any():
            i = int(broken.argmax())
            clipped = np.clip(scaled, low / load**LEAST_EXPONENT, high / load**LEAST_EXPONENT)
            nearest = np.maximum.accumulate(clipped) * load**LEAST_EXPONENT
            raise Infeasible(
                f"sample {i + 1} (load {load[i]:g}, friction {friction[i]:g} mm^2) is {words}, "
                f"{bound[i]:.6g} mm^2, for any surface of radius {radius:g} mm{_margin_words(margin)}",
                SampledLaw(load, nearest, target.weight),
            )


def refuse_power(target: PowerLaw, radius: float, count: int, limits: Limits, margin: float) -> None:
    """Raise Infeasible for an exponent or a prefactor beyond its bound by more than a margin (relative)."""
    low, high = target.load_range
    refuse_load(high, radius, count, limits)
    most = largest_exponent(target.load_range, count)
    slack = margin / math.log(high / low)
    if not LEAST_EXPONENT - slack - ROUNDING <= target.exponent <= most + slack + ROUNDING:
        nearest = min(max(target.exponent, LEAST_EXPONENT), most)
        raise Infeasible(
            f"exponent {target.exponent:g} over loads from {low:g} to {high:g} mm^2 cannot be reached: at "
            f"least {LEAST_EXPONENT:.4g} and at most {most:.4g} with {count} asperities of one radius"
            f"{_margin_words(margin)}",
            PowerLaw(nearest, target.load_range),
        )
    if target.prefactor is not None:
        load = np.array(target.load_range)
        refuse_sampled(
            SampledLaw(load, target.prefactor * load**target.exponent), radius, count, limits, margin
        )


def refuse_multilinear(
    target: MultilinearLaw, radius: float, count: int, limits: Limits, margin: float
) -> None:
    """Raise Infeasible where no intercept keeps a run of branches that meet within the bounds."""
    refuse_load(target.load_range[1], radius, count, limits)
    slack = margin + ROUNDING
    offset, low, high = 0.0, -math.inf, math.inf
    for i, (slope, (start, end)) in enumerate(target.branches):
        free = i > 0 and start > target.branches[i - 1][1][1]
        if free:
            offset, low, high = 0.0, -math.inf, math.inf
        elif i:
            offset += (target.slopes[i - 1] - slope) * start
        # F = c + offset + slope p is straight, the bounds are concave: the lower one binds at the ends or
        # where it is as steep as F, the upper one at the ends alone
        load = np.array([start, end, min(max((2 / 3 * _single(radius) / slope) ** 3, start), end)])
        least, most = friction_bounds(load, radius, count)
        low = max(low, float((least * (1.0 - slack) - offset - slope * load).max()))
        high = min(high, float((most * (1.0 + slack) - offset - slope * load)[:2].min()))
        # F/p^(2/3) cannot fall: c + offset <= slope p/2, first broken at the start
        high = min(high, slope * start * (0.5 + slack) - offset)
        if low > high:
            raise Infeasible(
                f"branch {i + 1} of slope {slope:g} from {start:g} to {end:g} mm^2 leaves what {count} "
                f"asperities of radius {radius:g} mm can have, whatever its intercept"
                f"{_margin_words(margin)}"
            )


def _single(radius: float) -> float:
    """Return c of the friction ``c p^(2/3)`` of a single asperity."""
    return float(friction_bounds(np.array([1.0]), radius, 1)[0][0])


def refuse_load(load: float, radius: float, count: int, limits: Limits) -> None:
    """Raise Infeasible for a load beyond that at which the plane reaches the base plane."""
    most = largest_load(radius, count, limits)
    if load > most:
        raise Infeasible(
            f"load {load:g} mm^2 is beyond {most:.6g} mm^2, at which {count} summits of the largest height "
            "have the plane at the base plane; raise max_height or offset, or use more asperities"
        )


def _margin_words(margin: float) -> str:
    return f" (the model's interaction leaves a margin of {100.0 * margin:.2g} %)" if margin > 0.0 else ""
