"""Design of a surface for a target law."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.caps import Power
from metafem.errors import Infeasible
from metafem.inversion.adjustment.height_steps import rounded_to_steps
from metafem.inversion.adjustment.pinned import with_pinned
from metafem.inversion.adjustment.refinement import refined
from metafem.inversion.assessment import DesignStatus, assess
from metafem.inversion.candidate import Candidate, Parameter
from metafem.inversion.design_notes import design_notes
from metafem.inversion.feasibility import achievable_friction_coefficients
from metafem.inversion.limits import Limits
from metafem.inversion.problem import Problem
from metafem.inversion.result import Design
from metafem.inversion.strategies import tools as strategy
from metafem.inversion.targets.target import Target
from metafem.inversion.tools.kit import Given, Kit
from metafem.models import Model
from metafem.notes import when_read
from metafem.progress import doing
from metafem.surface import Surface

# If a design uses more radii of a range than this, only the smallest and the largest are stated.
MOST_LISTED = 8


def design(
    target: Target,
    template: Surface,
    model: Model | None = None,
    limits: Limits | None = None,
    rng: Any = 0,
    *,
    tools: Given | None = None,
) -> Design:
    """Return a design: heights, and radii if several are allowed, whose friction law meets the target.

    Parameters
    ----------
    target : OperatingPoints, LinearLaw, BilinearLaw, SampledLaw, PowerLaw, MultilinearLaw or Band
        With a load range, a linear or bilinear law is a line through the origin over that range. Without a
        load range the heights follow a density whose law has the target slopes but its own intercept.
    template : Surface
        Surface with the sites, common radius, material, friction and block. Its heights are used only for the
        default of `limits`, and its radii only if `tools` is not given.
    model : Model, optional
        Model under which the law must meet the target; default: ``Independent()``. For a model with
        interaction, heights are first found for independent asperities with the contact law of the model. The
        Levenberg–Marquardt method with exact sensitivities then refines them. Bounds use the same contact
        law. For adhesive asperities no bound is used,
        and heights that follow a density are those without adhesion.
    limits : Limits, optional
        Manufacturing limits; default: heights up to the tallest of the template. With a `height_step` all
        heights are on its levels. A note and the parameter ``step_loss`` [-] then state the increase of
        the misfit, and the parameters ``step_levels`` [mm] and ``step_counts`` the levels. For a linear law
        of independent asperities the numbers of asperities per level are the integers nearest to those of
        the density. With `pinned` the other heights are adjusted to the prescribed heights, see Notes.
    rng : int or numpy Generator
        Seed of the random assignment of heights to sites, and of the random restarts of the search.
    tools : sequence of Tool or of float, RadiusRange or PowerRange, optional
        Tools of which one makes each asperity: a list of tools or of their radii [mm], the radii of a range,
        or power caps with the exponents of a range, on its steps. Plain radii have the common cap of the
        template. All asperities are made by the same tool if a single tool reaches the target; otherwise
        tools are mixed. For operating points and other laws over a range of loads, heights and tools are
        searched together. Linear and bilinear laws without a load range, whose heights follow a density, can
        mix two radii of one cap; their law is that of the single radius ``R = (<R>/<sqrt R>)^2``. The tools
        are found for independent asperities; under another model only the heights are refined. Several radii
        or caps reach local exponents of a law below 2/3, larger slopes, and laws that saturate. If not all
        caps are spheres or paraboloids, the default contact law is `Elastic()`. Default: the common radius
        and cap of the template.

    Returns
    -------
    Design
        With radii as `tools`, the parameters of the design include ``used_radii`` [mm], the radii in use, and
        ``radius_counts``, the number of asperities of each radius. For many radii of a range they include
        ``lowest_radius`` and ``highest_radius`` [mm] instead. For tools of several shapes they include
        ``tool_counts``, the number of asperities of each tool, and for a range of exponents
        ``used_exponents`` [-] and ``exponent_counts``.

        With radii and a template that has a friction, the parameters also include ``lowest_coefficients``
        [-] and, if `limits.height_sd` is given, ``highest_coefficients`` [-]. These are bounds on the
        friction coefficients of linear laws with a single radius, for each of the
        ``tried_radii``. ``reachable_coefficients`` [-] are the two bounds for mixtures of the radii.

    Raises
    ------
    Infeasible
        If no surface within the limits has the law, or no heights that meet the points were found. The
        message states the reason, and the attribute `nearest` holds the nearest reachable target, if known.
    InvalidInput
        For arguments outside their range or of the wrong kind.

    Notes
    -----
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, equations S1 to S8.

    With `limits.pinned`, the heights are first found without the prescribed heights. The
    prescribed heights then replace the nearest heights and take over their radii. They need not be on a
    height step. The other heights are adjusted by the Levenberg–Marquardt method, each between the foot and
    the largest height. They remain unchanged if the prescribed heights raise the misfit by less than about a
    tenth, except for operating points. A note states the misfits with and without the prescribed heights.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> result = mf.design(mf.LinearLaw(6.87), template)
    >>> round(result.parameters["scale"], 4), result.misfit < 0.03
    (0.0401, True)

    A local exponent below 2/3 needs two tools.

    >>> target, limits = mf.PowerLaw(0.64, (0.1, 0.2)), mf.Limits(0.27)
    >>> mf.design(target, template, limits=limits, tools=[0.2, 0.8]).parameters["used_radii"]
    array([0.2, 0.8])

    Site 9 has a summit of 0.1 mm, and site 3 has no asperity.

    >>> limits = mf.Limits(0.12, pinned={9: 0.1, 3: None})
    >>> result = mf.design(mf.PowerLaw(0.9, (0.1, 0.2)), template, limits=limits)
    >>> result.surface.height[result.sites == 9], 3 in result.sites, result.misfit < 0.01
    (array([0.1]), False, True)
    """
    problem = Problem.checked(target, template, model, limits, tools)
    generator = check.generator(rng)
    _refuse_infeasible(problem)
    with doing("inverting the law"):
        permutation = problem.pins.placed(generator.permutation(template.count))
        several = isinstance(problem.tools, Kit)
        candidate = (strategy if several else problem.target).candidate(problem, generator)
        candidate = candidate.placed(permutation[: len(candidate.height)], problem.limits.foot)
    candidate = problem.target.judged(problem, refined(problem, candidate, generator))
    unrounded, candidate = candidate, rounded_to_steps(problem, candidate)
    if problem.pins.rows.size:
        candidate = with_pinned(problem, candidate, unrounded, generator)
    surface = candidate.surface(problem.template)
    found = assess(problem, candidate, surface)
    if tools is not None:
        found["parameters"] |= _tools_in_use(problem, surface)
    result = Design(
        surface=surface,
        sites=problem.pins.open[candidate.sites],
        target=target,
        template=template,
        limits=problem.limits,
        density=candidate.density,
        tools=None if tools is None else problem.tools.given_as,
        pinned=problem.pins.pinned,
        **found,
    )
    size = surface.count + result.law.load.size
    return replace(result, notes=when_read(design_notes, problem, candidate, result, size=size))


def _refuse_infeasible(problem: Problem) -> None:
    """Raise Infeasible if the target exceeds a bound by more than the interaction margin of the model."""
    try:
        problem.target.refuse(problem, 0.0)
    except Infeasible:
        margin = problem.interaction_margin()
        if margin == 0.0:
            raise
        problem.target.refuse(problem, margin)


def _kit_in_use(kit: Kit, surface: Surface) -> dict[str, Parameter]:
    """Return the parameters that state the tools of a surface."""
    if kit.range is None:
        return {"tool_counts": _tool_counts(kit, surface)}
    made = Counter(surface.cap.one(i) for i in range(surface.count))
    exponents = {cap.exponent: number for cap, number in made.items() if isinstance(cap, Power)}
    used = sorted(exponents)
    return {"used_exponents": np.array(used), "exponent_counts": np.array([exponents[n] for n in used])}


def _tool_counts(kit: Kit, surface: Surface) -> IntArray:
    """Return the number of asperities of each tool of a list, (t,)."""
    radii, caps = surface.radius.tolist(), [surface.cap.one(i) for i in range(surface.count)]
    made = Counter(zip(radii, caps, strict=True))
    return np.array([made[tool.radius, tool.cap] for tool in kit.tools])


def _tools_in_use(problem: Problem, surface: Surface) -> dict[str, Parameter]:
    """Return the parameters that state the tools of a surface, and the friction coefficients they allow."""
    radii, template = problem.tools, problem.template
    if isinstance(radii, Kit):
        return _kit_in_use(radii, surface)
    used, counts = np.unique(surface.radius, return_counts=True)
    parameters: dict[str, Parameter] = {"used_radii": used, "radius_counts": counts.astype(np.int64)}
    if radii.tools is None and len(used) > MOST_LISTED:
        parameters = {"lowest_radius": float(used[0]), "highest_radius": float(used[-1])}
    if template.friction is not None:
        given = problem.limits, radii.given_as, problem.contact
        reach = np.array(achievable_friction_coefficients(template, *given))
        parameters |= {"tried_radii": radii.tried, **_coefficients(problem, radii.tried)}
        if np.isfinite(reach).all():
            parameters["reachable_coefficients"] = reach
    return parameters


def _coefficients(problem: Problem, radii: FloatArray) -> dict[str, Parameter]:
    """Return bounds on the friction coefficients [-] of linear laws, separately for each radius."""
    if problem.template.friction is None:
        return {}
    template, limits, law = problem.template, problem.limits, problem.contact
    each_radius = ([radius] for radius in radii.tolist())
    bounds = np.array([achievable_friction_coefficients(template, limits, r, law) for r in each_radius])
    reach: dict[str, Parameter] = {"lowest_coefficients": bounds[:, 0]}
    if np.isfinite(bounds).all():
        reach["highest_coefficients"] = bounds[:, 1]
    return reach


def problem_of(design: Design) -> Problem:
    """Return the problem of which a design is the result."""
    return Problem.checked(
        design.target, design.template, design.law.model, design.limits, tools=design.tools
    )


def candidate_of(design: Design, problem: Problem) -> Candidate:
    """Return the candidate with the heights of a design on the sites of its problem."""
    surface = design.surface
    return Candidate(
        surface.height,
        surface.radius,
        design.parameters,
        design.target_law,
        tuple(branch for branch, _ in design.fits),
        design.density,
        stepped=design.limits.height_step is not None,
        lowest_level=float(surface.height.min()) if design.target.exact else None,
        sites=np.searchsorted(problem.pins.open, design.sites),
        moved=design.status is DesignStatus.REFINED,
        cap=surface.cap,
    )
