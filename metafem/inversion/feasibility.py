"""Checks of targets against bounds, and the range of laws that independent asperities can reach."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import isotonic_regression

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.contact import Contact
from metafem.errors import Infeasible, InvalidInput, MetafemWarning
from metafem.inversion.bounds import ROUNDING, Bounds
from metafem.inversion.height_density import FINEST_SCALE_IN_SD, ExponentialDensity, uniform_slope
from metafem.inversion.limits import Limits
from metafem.inversion.targets.wording import Message, Wording
from metafem.inversion.tools.kit import Choice, Given, chosen, pressed, refuse_curvature, singles
from metafem.inversion.tools.kit_bounds import KitBounds
from metafem.inversion.tools.radii import Radii
from metafem.models.model import PARABOLOID, checked_contact
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.inversion.problem import Problem

# The nearest reachable target is inside its bound by this relative distance.
INSIDE = 1e-6

# Plasticity index below which contacts are mostly elastic, according to Greenwood and Williamson.
ELASTIC_LIMIT = 0.6

# Its name in notes and figures.
INDEX = "plasticity index"


def broken_bound(
    load: FloatArray, friction: FloatArray, bounds: Bounds, margin: float
) -> tuple[int, str, float] | None:
    """Return the first point that violates a bound: its index, the bound in words, and the bound [mm^2].

    Violations within a relative margin are ignored. The result is None if no point (k,) violates a bound.
    """
    low, high = bounds.friction(load)
    exponent, slack = bounds.least_exponent, margin + ROUNDING
    least = load**exponent
    scaled = friction / least
    top = np.maximum.accumulate(scaled)
    jump = bounds.highest_after(load, friction)
    power = "(2/3)" if exponent == 2.0 / 3.0 else f"{exponent:.4g}"
    for broken, words, bound in (
        (friction < low * (1.0 - slack), "below that of a single asperity", low),
        (friction > high * (1.0 + slack), f"above that of {bounds.count} equal asperities", high),
        (
            scaled < top * (1.0 - slack),
            f"below that of the asperities in contact at smaller loads (F/P^{power} cannot fall)",
            top * least,
        ),
        (
            friction > jump * (1.0 + slack),
            f"above that of {bounds.count} asperities that all come into contact after a smaller load",
            jump,
        ),
    ):
        if broken.any():
            i = int(broken.argmax())
            return i, words, float(bound[i])
    return None


def broken_sample(
    load: FloatArray,
    friction: FloatArray,
    problem: Problem,
    wording: Wording,
    margin: float,
    point: tuple[str, str, str] | None = None,
) -> Message | None:
    """Return a message on the first sample (k,) that violates a bound by more than a margin, or None.

    `point` holds the words before the load of the sample, between its load and friction, and after both.
    """
    broken = broken_bound(load, friction, problem.bounds, margin)
    if broken is None:
        return None
    i, words, bound = broken
    before, between, after = point or (f"sample {i + 1} (load ", ", friction ", ")")
    where, what = ("loads", load[i]), ("frictions", friction[i])
    scope = f", for any surface of {problem.tools}{margin_words(margin)}"
    parts = (before, where, between, what, f"{after} is {words}, ", ("frictions", bound), scope)
    return Message(parts, wording)


def nearest_within(load: FloatArray, friction: FloatArray, weight: FloatArray, bounds: Bounds) -> FloatArray:
    """Return frictions (k,) [mm^2] within the bounds, with minimal weighted differences from the samples.

    F/P^b cannot decrease, so the frictions follow from an isotonic regression. The regression remains optimal
    when clipped at bounds that are powers of the load with the same exponent b.
    """
    if broken_bound(load, friction, bounds, 0.0) is None:
        return friction
    low, high = bounds.friction(load)
    least = load**bounds.least_exponent
    scaled = friction / least
    rising = isotonic_regression(scaled, weights=weight / scaled**2).x
    jump = bounds.highest_after(load, rising * least)
    return np.maximum.accumulate(np.clip(rising, low / least, np.minimum(high, jump) / least)) * least


def refuse_load(load: float, problem: Problem, wording: Wording) -> None:
    """Raise Infeasible if a load exceeds the load at which the plane reaches the base plane."""
    most = problem.bounds.largest_load(problem.limits)
    if load > most:
        words = (
            f", at which the plane reaches the base plane with {problem.count} summits of the largest height"
            "; raise max_height or offset, or use more asperities"
        )
        parts = ("load ", ("loads", load), " is beyond ", ("loads", most), words)
        raise Infeasible(Message(parts, wording))


def margin_words(margin: float) -> str:
    """Return the margin in words, or nothing if it is 0."""
    return f" (the model's interaction leaves a margin of {percent(margin)})" if margin > 0.0 else ""


def bounds_of(choice: Choice, template: Surface, contact: Contact, last: float) -> Bounds:
    """Return the bounds for the tools of a choice, up to a load [mm^2]."""
    refuse_curvature(choice, template, contact)
    if isinstance(choice, Radii):
        return Bounds(pressed(choice, template, contact)[0], choice, template.count, last)
    alone = [(part, Radii.of(float(part.radius[0]))) for part in singles(choice, template)]
    parts = tuple(
        Bounds(pressed(radius, part, contact)[0], radius, part.count, last) for part, radius in alone
    )
    return KitBounds.of(parts, pressed(choice, template, contact)[0])


def feasible_region(
    template: Surface,
    rescaled_load: ArrayLike,
    limits: Limits,
    tools: Given | None = None,
    contact: Contact = PARABOLOID,
) -> tuple[FloatArray, FloatArray]:
    """Return the lowest and highest friction of any surface of independent asperities at each load.

    One asperity of the smallest radius has the lowest friction; with a Hertz contact it is
    ``pi R (3p/(4 sqrt R))^(2/3)``. N equal asperities of the largest radius have the highest friction. Both
    values are nan above the load at which the plane reaches the base plane with N summits of the largest
    height. They hold for every contact law whose load is a convex function of the area, see
    `metafem.inversion.bounds`. They are 0 and infinite for other laws, with adhesion, and for several radii
    if the law does not scale with the radius.

    Parameters
    ----------
    template : Surface
        Surface of which only the number N of sites is used, and the common radius if `tools` is not given.
    rescaled_load : array_like, (k,)
        P/E* [mm^2], positive.
    limits : Limits
    tools : sequence of Tool or of float, RadiusRange or PowerRange, optional
        Tools of which one makes each asperity, as in `design`; default: the radius and cap of the template.
    contact : Contact
        Law of one contact; default: `Hertz()`.

    Returns
    -------
    low, high : ndarray, (k,)
        F/(sigma B) [mm^2].

    Raises
    ------
    InvalidInput
        If a load or a radius is not positive, or if the template has several radii and `tools` is not given.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> low, high = feasible_region(template, [0.1, 0.4], Limits(0.12))
    >>> (high / low).round(12)
    array([4., 4.])
    >>> flat = template.replaced(cap=mf.Power(4))
    >>> low, high = feasible_region(flat, [0.1, 0.4], Limits(0.12), contact=mf.Elastic())
    >>> (high / low).round(4)
    array([12.1257, 12.1257])
    """
    check.instance("template", template, Surface, "a metafem.Surface")
    check.instance("limits", limits, Limits, "metafem.Limits")
    load = check.array("rescaled_load", rescaled_load, shape=(None,), positive=True)
    bounds = bounds_of(*chosen(tools, template), checked_contact(contact), float(load.max()))
    within = load <= bounds.largest_load(limits)
    low, high = np.full((2, len(load)), np.nan)
    if within.any():
        bounds = replace(bounds, last=float(load[within].max()))
        low[within], high[within] = bounds.friction(load[within])
    return low, high


def achievable_friction_coefficients(
    template: Surface,
    limits: Limits,
    tools: Given | None = None,
    contact: Contact = PARABOLOID,
) -> tuple[float, float]:
    """Return the smallest and largest friction coefficient of linear laws from exponential height densities.

    Uniformly distributed heights have the smallest coefficient, ``A(h_m)/P(h_m) sigma B / E*`` with the area
    and the load of one contact. With Hertz contacts it is ``3 pi/4 sqrt(R/h_m) sigma B / E*``. The density
    with the smallest scale that can be manufactured, ten times `limits.height_sd`, has the largest
    coefficient; without a `height_sd` it is infinite. If several radii are allowed, the lower bound is that
    of the smallest radius and the upper bound that of the largest radius. Mixtures of the radii reach all
    values in between.

    Parameters
    ----------
    template : Surface
        Template with a friction, and with one common radius unless `tools` is given.
    limits : Limits
    tools : sequence of Tool or of float, RadiusRange or PowerRange, optional
        Tools of which one makes each asperity, as in `design`; default: the radius and cap of the template.
    contact : Contact
        Law of one contact; default: `Hertz()`. Adhesion is ignored.

    Returns
    -------
    low, high : float
        Friction coefficients mu [-].

    Raises
    ------
    InvalidInput
        If the template has no friction, if it has several radii and `tools` is not given, or if a radius is
        not positive.

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
    stress = template.friction.stress
    choice, template = chosen(tools, template)
    per_slope = stress / template.material.composite_modulus
    bounds = bounds_of(choice, template, checked_contact(contact), 0.0)
    parts = bounds.parts if isinstance(bounds, KitBounds) else (bounds,)
    low = min(uniform_slope(part.radii.low, limits.span, part.law.without_adhesion) for part in parts)
    high = math.inf
    if limits.height_sd:
        finest = ExponentialDensity(FINEST_SCALE_IN_SD * limits.height_sd, limits.span)
        high = max(finest.asymptotic_slope(part.radii.high, part.law.without_adhesion) for part in parts)
    return low * per_slope, high * per_slope


def roughness(surface: Surface) -> float:
    """Return sqrt(s/R) [-]: s is the standard deviation of the heights, R the mean radius of curvature."""
    return math.sqrt(float(surface.height.std()) / float(surface.cap.summit_radius(surface.radius).mean()))


def plasticity_index(surface: Surface, hardness: float) -> float:
    """Return the plasticity index of a surface, ``psi = E*/H sqrt(s/R)``.

    Here s is the standard deviation of the heights and R the mean radius. An elastic model is suitable
    below 0.6; above it, a MetafemWarning is issued.

    Parameters
    ----------
    surface : Surface
    hardness : float
        H of the softer material [MPa], positive.

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
    psi = surface.material.composite_modulus / h * roughness(surface)
    if psi >= ELASTIC_LIMIT:
        warnings.warn(
            f"plasticity index {psi:.3g} is not below {ELASTIC_LIMIT}: the contacts will deform "
            "plastically; choose a material with a smaller E*/H, larger radii or closer heights",
            MetafemWarning,
            stacklevel=2,
        )
    return psi
