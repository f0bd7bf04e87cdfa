"""Proofs that no surface reaches a target, with the nearest law, and the range of what surfaces reach."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import linprog

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import percent
from metafem.contact import Contact
from metafem.errors import Infeasible, InvalidInput, MetafemWarning, refuse_if
from metafem.inversion.bounds import ROUNDING, Bounds
from metafem.inversion.density import FINEST_SCALE_IN_SD, ExponentialDensity, uniform_slope
from metafem.inversion.limits import Limits
from metafem.inversion.problem import Problem
from metafem.inversion.target_law import TargetLaw
from metafem.inversion.tools import Given, Tool, Tools
from metafem.inversion.wording import Wording
from metafem.models.model import PARABOLOID, checked_contact
from metafem.surface import Surface

# Plasticity index below which contacts are mostly elastic, according to Greenwood and Williamson.
ELASTIC_LIMIT = 0.6

# A nearest law is inside its bounds by this part of its distance from the target.
INSIDE = 1e-3

# Its name in notes and figures.
INDEX = "plasticity index"

# A hint is looked for up to this factor of the radius or of the number of sites. It is beyond the bound by
# these factors, of which the first is stated with which a design meets the target.
FURTHEST, BEYOND = 30.0, (1.02, 1.1, 1.3, 1.7)

# Number of bisections in the search for a hint.
BISECTIONS = 12


def nearest_law(law: TargetLaw, bounds: Bounds, margin: float = 0.0) -> tuple[float, FloatArray]:
    """Return the largest relative distance [-] of a target from the nearest law in the bounds, and that law.

    The frictions F_k, the free parameters c and the distances s_k solve the linear program: minimise the sum
    of s where ``lower + free c - s w <= F <= upper + free c + s w``, F lies within the bounds, and F/p^b does
    not fall with the least local exponent b. w is the target, or the middle of the bounds if it has free
    parameters. Few s differ from 0, so that few points move. A law without free parameters must also not rise
    faster than N asperities that all come into contact. All bounds are wider by a relative margin.
    """
    load, target = law.load, law.middle
    if not bounds.convex:
        return 0.0, target
    low, high = bounds.friction(load)
    w = np.sqrt(low * high) if law.is_open else target
    k, q = law.free.shape
    one, free, nothing = np.eye(k), law.free / w[:, None], np.zeros((k - 1, k + q))
    power = w / load**bounds.least_exponent
    rising = (1.0 - margin) * one[:-1] - one[1:] * (power[1:] / power[:-1])[:, None]
    rows = np.block([[one, -free, -one], [-one, free, -one], [rising, nothing]])
    right = np.concatenate([law.upper / w, -law.lower / w, np.zeros(k - 1)])
    ends = zip(low / w * (1.0 - margin), high / w * (1.0 + margin), strict=True)
    limits = [*ends, *[(None, None)] * q, *[(0.0, None)] * k]
    found = linprog(np.append(np.zeros(k + q), np.ones(k)), rows, right, bounds=limits, method="highs")
    if found.x is None:  # the bounds exclude each other by rounding
        return 0.0, target
    distance, friction = float(found.x[-k:].max()), found.x[:k] * w
    if not law.is_open:
        jump = bounds.highest_after(load, friction if law.is_band else target) * (1.0 + margin)
        distance = max(distance, float((np.minimum(friction, law.lower) / jump).max()) - 1.0)
        friction = np.minimum(friction, bounds.highest_after(load, friction))
    return distance, friction


def prove(problem: Problem, within: float) -> None:
    """Raise Infeasible if the target exceeds a proven bound by more than the interaction can change.

    Samples whose rms difference may be within a tolerance [-] are not excluded.
    """
    law, wording = problem.law, problem.target.wording
    if law is None:
        return
    last, most = float(law.load[-1]), problem.bounds.largest_load(problem.limits)
    if last > most and last > most * (1.0 + problem.margin):
        raise Infeasible(
            f"load {wording.loads(last)} is beyond {wording.loads(most)}, at which the plane reaches the "
            f"base plane with {problem.count} summits of the largest height; raise max_height or offset, or "
            "use more asperities"
        )
    samples = problem.target.refused and not problem.target.exact and not law.is_band
    allowed = within * math.sqrt(len(law.load) / law.weight.min()) if samples else 0.0
    if law.noise or nearest_law(law, problem.bounds)[0] <= allowed + ROUNDING:
        return
    margin = problem.margin
    distance, friction = nearest_law(law, problem.bounds, margin)
    if distance <= allowed + ROUNDING:
        return
    extra = f" (the model's interaction leaves a margin of {percent(margin)})" if margin else ""
    scope = f"for any surface of at most {problem.count} asperities of {problem.tools}{extra}"
    words = _broken(law, friction, problem.bounds, problem.target.wording)
    inside = friction if law.is_open else friction + INSIDE * (friction - law.law(friction))
    raise Infeasible(f"{words}, {scope}", problem.target.near(law.load, inside))


def _broken(law: TargetLaw, friction: FloatArray, bounds: Bounds, wording: Wording) -> str:
    """Return which bound a target breaks, at the load of the largest difference from the nearest law."""
    load = law.load
    if law.is_open:
        i = int(np.abs(law.difference(friction)).argmax())
        return (
            f"no free parameter brings the law within the bounds: the nearest law differs by "
            f"{percent(abs(float(law.difference(friction)[i])), '.3g')} at {wording.loads(load[i])}"
        )
    low, high = bounds.friction(load)
    distance = np.maximum(law.lower / friction, friction / law.upper) - 1.0
    i = int(distance.argmax())
    end = law.lower if law.lower[i] > friction[i] else law.upper
    if end[i] < low[i]:
        words = "below that of a single asperity"
    elif end[i] > high[i]:
        words = f"above that of {bounds.count} equal asperities"
    elif end[i] < friction[i]:
        power = "(2/3)" if bounds.least_exponent == 2.0 / 3.0 else f"{bounds.least_exponent:.4g}"
        words = f"below that of the asperities in contact at smaller loads (F/P^{power} cannot fall)"
    else:
        words = "above what the law at the other loads allows"
    return (
        f"at load {wording.loads(load[i])} the friction {wording.frictions(end[i])} is {words}, "
        f"{wording.frictions(friction[i])}"
    )


def remedies(problem: Problem, meets: Callable[[Problem], bool]) -> str:
    """Return how many sites, and which radius, reach a target that a bound excludes; "" if none was found.

    meets: whether a design for a problem meets its target; it is asked before anything is recommended.
    """
    more = _first(partial(_with_count, problem), meets)
    words = [f"{more.count} sites in all"] if more else []
    if len(problem.tools) == 1:
        for sign in (1.0, -1.0):
            other = _first(partial(_with_radius, problem, sign), meets)
            words += [f"a radius of {other.tools.all[0].radius:.4g} mm"] if other else []
    return f"; use {' or '.join(words)}" if words else ""


def _first(change: Callable[[float], Problem], meets: Callable[[Problem], bool]) -> Problem | None:
    """Return the problem changed by the least factor with which a design meets the target, or None."""

    def possible(factor: float) -> bool:
        other = change(factor)
        within = float(other.law.load[-1]) <= other.bounds.largest_load(other.limits)
        return within and nearest_law(other.law, other.bounds)[0] <= ROUNDING

    if not possible(FURTHEST):
        return None
    low, high = 0.0, math.log(FURTHEST)
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if possible(math.exp(middle)) else (middle, high)
    tried = (change(math.exp(high) * beyond) for beyond in BEYOND)
    return next((other for other in tried if meets(other)), None)


def _with_count(problem: Problem, factor: float) -> Problem:
    """Return the problem of independent asperities on more sites."""
    count, given = math.ceil(problem.count * factor), problem.template
    position = np.column_stack([float(given.radius.max()) * np.arange(count), np.zeros(count)])
    template = Surface(position, np.zeros(count), given.radius[0], given.material, cap=given.cap.one(0))
    return replace(problem, template=template, model=problem.uncoupled, pinned={})


def _with_radius(problem: Problem, sign: float, factor: float) -> Problem:
    """Return the problem of independent asperities with another radius, rounded to four digits."""
    tool = problem.tools.all[0]
    changed = Tool(float(f"{tool.radius * factor**sign:.4g}"), tool.cap)
    tools = Tools.of([changed], problem.template, problem.uncoupled.contact)
    return replace(problem, tools=tools, model=problem.uncoupled)


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
    `metafem.inversion.bounds`; they are 0 and infinite for other laws and with adhesion.

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
    choice = Tools.of(tools, template, checked_contact(contact))
    bounds = Bounds(choice, template.count, float(load.max()))
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

    Uniformly distributed heights have the smallest coefficient, ``3 pi/4 sqrt(R/h_m) sigma B / E*`` with
    Hertz contacts. The density with the smallest scale that can be manufactured, ten times
    `limits.height_sd`, has the largest coefficient; without a `height_sd` it is infinite. If several radii
    are allowed, the lower bound is that of the smallest radius and the upper bound that of the largest one.

    Parameters
    ----------
    template : Surface
        Template with a friction, and with one common radius unless `tools` is given.
    limits : Limits
    tools : sequence of Tool or of float, RadiusRange or PowerRange, optional
        Tools of which one makes each asperity, as in `design`; default: the radius and cap of the template.
    contact : Contact
        Hertz's law (default) or JKR's, whose adhesion is ignored.

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
    choice = Tools.of(tools, template, checked_contact(contact))
    words = f"needs Hertz contacts without adhesion or with it, not {choice.law!r}"
    refuse_if(choice.law.without_adhesion.power != 2.0, words, key="contact")
    per_slope = stress / template.material.composite_modulus
    radii = [summit for _, summit in choice.laws]
    low, high = uniform_slope(min(radii), limits.span), math.inf
    if limits.height_sd:
        finest = ExponentialDensity(FINEST_SCALE_IN_SD * limits.height_sd, limits.span)
        high = finest.asymptotic_slope(max(radii))
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
