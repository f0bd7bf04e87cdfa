"""Bounds on the friction of every surface of N independent asperities with radii between R1 and R2.

With contact radii a_i, ``p = P/E* = 4/3 sum a_i^3/R_i`` and ``A0 = pi sum a_i^2``. At a given load A0 is
least with one contact of radius R1 and largest with N equal contacts of radius R2. Along a law, ``dA0/dp =
(pi/2) sum R_i / sum a_i``; Cauchy's inequality between the sums of a, a^2 and a^3 gives a bound that depends
on A0 and p alone.

The local exponent is ``d ln A0/d ln p = 2/3 (sum R sum a^3/R) / (sum a^2 sum a)``. With one radius it is
never below 2/3, by Chebyshev's sum inequality. With several radii the ratio of the sums is least for two
kinds of contact, large caps with a/R = x and small caps with a/R = s^2 x. With k^2 = R1/R2 and
``1/(k^3 s^3)`` small caps for each large one the ratio is ``((1 + k s^3)/(s + k s^2))^2``, and it is least
at the root s > 1 of ``k^2 s^4 + 2 k s^3 - 2 k s - 1``.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from metafem import _validate as check
from metafem._calls import checked_call
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.contact import Hertz
from metafem.errors import Infeasible, InvalidInput, MetafemWarning
from metafem.inversion.height_density import FINEST_SCALE_IN_SD, TruncatedExponential, uniform_slope
from metafem.inversion.limits import Limits
from metafem.inversion.radii import Radii, RadiusRange
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.inversion.problem import Problem
    from metafem.inversion.targets.wording import Wording

# A value this close to a bound counts as the bound: rounding must not refuse values taken from a surface.
ROUNDING = 1e-9

# The nearest target that can be reached is inside its bound by this relative distance.
INSIDE = 1e-6

# Exponent of a fixed number of equal contacts, the least for any surface of one radius.
EQUAL_EXPONENT = 2.0 / 3.0

# Limit of mostly elastic contact by Greenwood and Williamson.
ELASTIC_LIMIT = 0.6


def friction_bounds(load: FloatArray, radii: Radii, count: int) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest friction at rescaled loads, (k,) [mm^2]: one contact, and N equal."""
    power = load**EQUAL_EXPONENT
    return single_friction(radii.low) * power, single_friction(radii.high) * count ** (1.0 / 3.0) * power


def single_friction(radius: float) -> float:
    """Return c of the friction ``c p^(2/3)`` of a single asperity [mm^(2/3)]."""
    return float(math.pi * radius * Hertz().indentation_at_load(1.0, radius))


def least_exponent(radii: Radii) -> float:
    """Return the least local exponent of a law: 2/3 for one radius, less for several."""
    k, s = math.sqrt(radii.low / radii.high), relative_depth(radii)
    return EQUAL_EXPONENT * ((1.0 + k * s**3) / (s + k * s * s)) ** 2


def relative_depth(radii: Radii) -> float:
    """Return s of the two kinds of contact: d/R of the small caps is s^4 times that of the large ones."""
    if radii.single:
        return 1.0
    k = math.sqrt(radii.low / radii.high)

    def slope(s: float) -> float:
        return k * k * s**4 + 2.0 * k * s**3 - 2.0 * k * s - 1.0

    # for s above 1 + (2/k)^(1/2) the terms 2 k s (s^2 - 1) > 4 s alone exceed 1: an upper bracket
    return float(brentq(slope, 1.0, math.sqrt(2.0 / k) + 1.0))


def largest_exponent(load_range: tuple[float, float], radii: Radii, count: int) -> float:
    """Return the largest exponent over a range, ``2/3 + ln(N^(1/3) (R2/R1)^(2/3)) / ln(P2/P1)``."""
    low, high = load_range
    wider = math.log(count) / 3.0 + EQUAL_EXPONENT * math.log(radii.high / radii.low)
    return EQUAL_EXPONENT + wider / math.log(high / low)


def largest_load(radii: Radii, count: int, limits: Limits) -> float:
    """Return the load P/E* [mm^2] that N asperities carry when the plane reaches the base plane."""
    depth = limits.offset + limits.max_height
    return count * float(Hertz().load_at_indentation(depth, radii.high))


def broken_bound(
    load: FloatArray, friction: FloatArray, radii: Radii, count: int, margin: float
) -> tuple[int, str, float, FloatArray] | None:
    """Return a bound that points (k,) break by more than a margin (relative), or None.

    The first point beyond it, the bound in words and in mm^2, and frictions (k,) within the bounds.
    """
    low, high = friction_bounds(load, radii, count)
    exponent, slack = least_exponent(radii), margin + ROUNDING
    least = load**exponent
    scaled = friction / least
    top = np.maximum.accumulate(scaled)
    # A0^3 - K p^2 cannot rise along a law: its steepest slope is 2/3 K p/A0^2, with K of N equal contacts
    rise = 9.0 / 16.0 * math.pi**3 * count * radii.high**2 * load**2
    jump = np.cbrt(np.minimum.accumulate(np.insert(friction**3 - rise, 0, 0.0))[:-1] + rise)
    power = "(2/3)" if radii.single else f"{exponent:.4g}"
    for broken, words, bound in (
        (friction < low * (1.0 - slack), "below that of a single asperity", low),
        (friction > high * (1.0 + slack), f"above that of {count} equal asperities", high),
        (
            scaled < top * (1.0 - slack),
            f"below that of the asperities in contact at smaller loads (F/P^{power} cannot fall)",
            top * least,
        ),
        (
            friction > jump * (1.0 + slack),
            f"above that of {count} asperities that all come into contact after a smaller load",
            jump,
        ),
    ):
        if broken.any():
            i = int(broken.argmax())
            clipped = np.clip(scaled, low / least, np.minimum(high, jump) / least)
            return i, words, float(bound[i]), np.maximum.accumulate(clipped) * least
    return None


def refuse_load(load: float, problem: Problem, wording: Wording) -> None:
    """Raise Infeasible for a load beyond that at which the plane reaches the base plane."""
    most = largest_load(problem.radii, problem.count, problem.limits)
    if load > most:
        raise Infeasible(
            f"load {wording.loads(load)} is beyond {wording.loads(most)}, at which the plane reaches the "
            f"base plane with {problem.count} summits of the largest height; raise max_height or offset, or "
            "use more asperities"
        )


def margin_words(margin: float) -> str:
    """Return the margin in words, or nothing if it is 0."""
    return f" (the model's interaction leaves a margin of {percent(margin)})" if margin > 0.0 else ""


@checked_call
def feasible_region(
    template: Surface,
    rescaled_load: ArrayLike,
    limits: Limits,
    radii: RadiusRange | Sequence[float] | None = None,
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest friction that any surface of independent asperities has at each load.

    The lowest is ``pi R (3p/(4 sqrt R))^(2/3)`` with the least radius; the highest is the same with the
    largest radius, times ``N^(1/3)``. Both are nan beyond the load at which, with N summits of the largest
    height, the plane reaches the base plane.

    Parameters
    ----------
    template : Surface
        Only its number N of sites is used, and its radius, one for all, where `radii` is not given.
    rescaled_load : array_like, (k,)
        P/E* [mm^2], positive.
    limits : Limits
    radii : RadiusRange or sequence of float, optional
        Radii that each asperity may have [mm]; default: the radius of the template.

    Returns
    -------
    low, high : ndarray, (k,)
        F/(sigma B) [mm^2].

    Raises
    ------
    InvalidInput
        For loads or radii that are not positive, or a template of several radii.

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
    choice = Radii.given(radii, template)
    low, high = friction_bounds(load, choice, template.count)
    beyond = load > largest_load(choice, template.count, limits)
    return np.where(beyond, np.nan, low), np.where(beyond, np.nan, high)


@checked_call
def achievable_friction_coefficients(
    template: Surface, limits: Limits, radii: RadiusRange | Sequence[float] | None = None
) -> tuple[float, float]:
    """Bounds on the friction coefficient of a linear law.

    The lower bound is that of uniformly distributed heights, ``3 pi/4 sqrt(R/h_m) sigma B / E*``. The
    upper bound is that of the smallest scale that can be made, ten times `limits.height_sd`; without a
    `height_sd` it is infinite. Where each asperity may have one of several radii, the lower bound is that
    of the least radius and the upper bound that of the largest; mixtures reach all values between.

    Parameters
    ----------
    template : Surface
        With a friction, and one common radius unless `radii` is given.
    limits : Limits
    radii : RadiusRange or sequence of float, optional
        Radii that each asperity may have [mm]; default: the radius of the template.

    Returns
    -------
    low, high : float
        Friction coefficients mu [-].

    Raises
    ------
    InvalidInput
        For a template without a friction or with several radii, and radii that are not positive.

    Notes
    -----
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, supplementary text.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(
    ...     0.12, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.358, 0.85)
    ... )
    >>> limits = Limits(max_height=0.120, height_sd=0.0009)
    >>> [round(mu, 3) for mu in achievable_friction_coefficients(template, limits)]
    [1.104, 3.032]
    """
    check.instance("limits", limits, Limits, "metafem.Limits")
    if template.friction is None:
        raise InvalidInput("template has no friction; a friction coefficient needs metafem.Friction")
    choice = Radii.given(radii, template)
    stress = template.friction.shear_strength * template.friction.area_ratio
    per_slope = stress / template.material.composite_modulus
    low = uniform_slope(choice.low, limits.span)
    high = math.inf
    if limits.height_sd:
        finest = TruncatedExponential(FINEST_SCALE_IN_SD * limits.height_sd, limits.span)
        high = finest.asymptotic_slope(choice.high)
    return low * per_slope, high * per_slope


@checked_call
def plasticity_index(surface: Surface, hardness: float) -> float:
    """Plasticity index of a surface, ``psi = E*/H sqrt(s/R)``.

    Here s is the standard deviation of the heights and R the mean radius. An elastic model is suitable
    below 0.6; above, a MetafemWarning is issued.

    Parameters
    ----------
    surface : Surface
    hardness : float
        H [MPa], positive.

    Returns
    -------
    float
        psi [-].

    Notes
    -----
    Greenwood and Williamson, Proc. R. Soc. A 295, 300 (1966), doi:10.1098/rspa.1966.0242.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface.square_lattice([0.1, 0.2], (1, 2), radius=0.5, material=mf.Material(1.36))
    >>> round(plasticity_index(surface, hardness=10.0), 4)
    0.043
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    h = check.number("hardness", hardness, above=0.0)
    ratio = surface.material.composite_modulus / h
    psi = ratio * math.sqrt(float(surface.height.std()) / float(surface.radius.mean()))
    if psi >= ELASTIC_LIMIT:
        warnings.warn(
            f"plasticity index {psi:.3g} is not below {ELASTIC_LIMIT}: the contacts will deform "
            "plastically; choose a material with a smaller E*/H, larger radii or closer heights",
            MetafemWarning,
            stacklevel=2,
        )
    return psi
