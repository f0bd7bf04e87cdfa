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
from metafem.inversion.adjustment.exponents import adjusted, free_exponents
from metafem.inversion.adjustment.height_steps import rounded_to_steps
from metafem.inversion.adjustment.pinned import with_pinned
from metafem.inversion.adjustment.refinement import refined
from metafem.inversion.adjustment.robustness import compared, made_robust
from metafem.inversion.assessment import EXACT, assess
from metafem.inversion.candidate import Parameter
from metafem.inversion.design_notes import design_notes
from metafem.inversion.feasibility import achievable_friction_coefficients
from metafem.inversion.limits import Limits
from metafem.inversion.placement.layout import Layout, arranged
from metafem.inversion.problem import Problem
from metafem.inversion.result import Design
from metafem.inversion.strategies import tools as strategy
from metafem.inversion.strategies.mixture import unreachable
from metafem.inversion.targets.target import Target
from metafem.inversion.tools.kit import Given, Kit
from metafem.inversion.tools.tool import Tool
from metafem.models import Model
from metafem.notes import information, when_read
from metafem.prediction.perturbation import Tolerances
from metafem.progress import doing, each
from metafem.surface import Surface

# If a design uses more radii of a range than this, only the smallest and the largest are stated.
MOST_LISTED = 8

# Maximum number of radii of a range that are tried between the best radius and its neighbours.
NEXT_RADII = 4


def design(
    target: Target,
    template: Surface,
    model: Model | None = None,
    limits: Limits | None = None,
    rng: Any = 0,
    layout: Layout | None = None,
    *,
    tools: Given | None = None,
    common_radius: bool = False,
    robust: Tolerances | None = None,
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
    layout : Layout, optional
        Objectives for the assignment of heights to sites. `arrange` assigns them under the model, before
        any refinement; the parameters ``layout_before`` and ``layout_after`` [-] are the misfits of the
        objectives. Default: a random assignment.
    tools : sequence of Tool or of float, RadiusRange or PowerRange, optional
        Tools of which one makes each asperity: a list of tools or of their radii [mm], any radius of a range,
        or power caps of any exponent of a range. Plain radii have the common cap of the template. All
        asperities are made by the same tool if a single tool reaches the target; otherwise tools are mixed.
        For operating points and other laws over a range of loads, heights and tools are searched together.
        Linear and bilinear laws without a load range, whose heights follow a density, can mix two radii of
        one cap; their law is that of the single radius ``R = (<R>/<sqrt R>)^2``. The tools are found for
        independent asperities; under another model only the heights and the exponents of a range are refined.
        Several radii or caps reach local exponents of a law below 2/3, larger slopes, and laws that saturate.
        If not all caps are spheres or paraboloids, the default contact law is `Elastic()`. Default:
        the common radius and cap of the template.
    common_radius : bool
        Whether all asperities are made by the same tool, the one with the smallest misfit. All tools of a
        list are tried, up to 13 radii of a range, and 7 exponents. The trials use neither `layout` nor
        `robust`.
    robust : Tolerances, optional
        Errors of the manufactured surface and of its alignment. The expected squared misfit over these
        errors is minimised, see Notes. Default: None; the misfit of the exact heights is minimised.

    Returns
    -------
    Design
        With radii as `tools`, the parameters of the design include ``used_radii`` [mm], the radii in use, and
        ``radius_counts``, the number of asperities of each radius. For many radii of a range they include
        ``lowest_radius`` and ``highest_radius`` [mm] instead. For tools of several shapes they include
        ``tool_counts``, the number of asperities of each tool, and for a range of exponents
        ``used_exponents`` [-] and ``exponent_counts``.

        With `common_radius`, the parameters include ``radius`` [mm] and, for all radii that can reach the
        target, ``tried_radii`` [mm] and ``radius_misfits`` [-]. A note lists the radii that cannot reach the
        target, with the reason.

        With radii and a template that has a friction, the parameters also include ``lowest_coefficients``
        [-] and, if `limits.height_sd` is given, ``highest_coefficients`` [-]. These are bounds on the
        friction coefficients of linear laws with a single radius, for each of the ``tried_radii``. Without
        `common_radius`, ``reachable_coefficients`` [-] are the two bounds for mixtures of the radii.

        With `robust`, the parameters include ``expected_misfit`` [-], the root of the expected squared misfit
        of the manufactured surface, and ``plain_expected_misfit`` [-], the same root for the design without
        `robust`. ``robust_gain`` [-] is the relative decrease of the expected squared misfit, and
        ``robust_gain_error`` [-] its standard error. ``irreducible_share`` [-] is the fraction of the
        expected squared misfit that is due to the linear response to errors of single heights and radii; no
        heights with this law can remove this response. If the gain is below three standard errors, the design
        without `robust` is returned, with a note.

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

    With `robust`, ``E |r(h + D)|^2`` is minimised, where r are the relative differences of the law from the
    target, h the heights and D their errors. The expectation is approximated by a mean over fixed errors of
    both signs, whose mean square is exact in every direction. The Levenberg–Marquardt method with
    exact sensitivities minimises this mean. If the tolerances include an angle, asperities are also exchanged
    between sites to reduce the response to tilts. With more than 128 asperities the heights do not change.
    If the model has no sensitivities, its `gradient_model` is used for the expectations. In general, the
    misfit of the exact heights increases.

    With `limits.pinned`, the heights and their layout are first found without the prescribed heights. The
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

    The larger tool cannot reach a slope of 4.5. A local exponent below 2/3 needs both tools.

    >>> tools = [0.3, 0.526]
    >>> mf.design(mf.LinearLaw(4.5), template, tools=tools, common_radius=True).parameters["radius"]
    0.3
    >>> target, limits = mf.PowerLaw(0.64, (0.1, 0.2)), mf.Limits(0.27)
    >>> mf.design(target, template, limits=limits, tools=[0.2, 0.8]).parameters["used_radii"]
    array([0.2, 0.8])

    The heights have errors of 3 um, and the plane is tilted by up to 0.05 degrees about each axis.

    >>> target, tolerances = mf.PowerLaw(0.9, (0.1, 0.2)), mf.Tolerances(height_sd=0.003, angle=0.0009)
    >>> found = mf.design(target, template, robust=tolerances).parameters
    >>> found["robust_gain"] > 3.0 * found["robust_gain_error"]
    True

    Site 9 has a summit of 0.1 mm, and site 3 has no asperity.

    >>> limits = mf.Limits(0.12, pinned={9: 0.1, 3: None})
    >>> result = mf.design(mf.PowerLaw(0.9, (0.1, 0.2)), template, limits=limits)
    >>> result.surface.height[result.sites == 9], 3 in result.sites, result.misfit < 0.01
    (array([0.1]), False, True)
    """
    check.instance("common_radius", common_radius, bool, "True or False")
    problem = Problem.checked(target, template, model, limits, layout, tools, robust)
    generator = check.generator(rng)
    if common_radius:
        return _with_common_radius(problem, generator)
    _refuse_infeasible(problem)
    with doing("inverting the law"):
        permutation = problem.pins.placed(generator.permutation(template.count))
        several = isinstance(problem.tools, Kit)
        candidate = (strategy if several else problem.target).candidate(problem, generator)
        candidate = candidate.placed(permutation[: len(candidate.height)], problem.limits.foot)
    candidate = arranged(problem, candidate, generator)
    refine = adjusted if free_exponents(problem, candidate) else refined
    candidate = problem.target.judged(problem, refine(problem, candidate, generator))
    plain = rounded_to_steps(problem, candidate)
    if problem.pins.rows.size:
        plain, candidate = with_pinned(problem, plain, candidate, generator)
    if robust is None:
        candidate = plain
    else:
        trial = rounded_to_steps(problem, made_robust(problem, candidate, generator))
        with doing("measuring the expected misfit"):
            candidate = compared(problem, plain, trial, generator)
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
        layout=layout,
        robust=robust,
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


def _with_common_radius(problem: Problem, rng: np.random.Generator) -> Design:
    """Return the design with the best common radius; the choice of the radius ignores layout and `robust`."""
    choice, pins, seed = problem.tools, problem.pins, int(rng.integers(2**63))
    if isinstance(choice, Kit):
        return _with_one_tool(problem, choice, seed)
    found: dict[float, Design] = {}
    refused: dict[float, Infeasible] = {}

    def attempt(radii: FloatArray, layout: Layout | None = None, robust: Tolerances | None = None) -> None:
        for radius in each("radius", radii.tolist()):
            part, again = pins.template.replaced(radius=radius), np.random.default_rng(seed)
            try:
                found[radius] = design(
                    problem.target, part, problem.model, problem.limits, again, layout, robust=robust
                )
            except Infeasible as reason:
                refused[radius] = reason

    def rank(radius: float) -> tuple[float, float]:
        """Return the misfit and the radius; misfits of exact designs are rounding errors and rank equally."""
        return max(found[radius].misfit, EXACT), radius

    attempt(choice.tried)
    if not found:
        raise unreachable(refused)
    if choice.tools is None:
        attempt(choice.tried_beside(min(found, key=rank), NEXT_RADII))
    best, tried = min(found, key=rank), np.array(sorted(found))
    misfits = np.array([found[radius].misfit for radius in tried.tolist()])
    if problem.layout is not None or problem.robust is not None:
        attempt(np.array([best]), problem.layout, problem.robust)
    radii: dict[str, Parameter] = {"radius": best, "tried_radii": tried, "radius_misfits": misfits}
    parameters = {**found[best].parameters, **radii, **_coefficients(problem, tried)}
    result = replace(found[best], parameters=parameters)
    if not refused:
        return result
    which = ", ".join(f"{radius:.4g}" for radius in sorted(refused))
    note = information(f"radii that cannot reach the target [mm]: {which}; {refused[min(refused)]}")
    return replace(result, notes=when_read(lambda: (*found[best].notes, note), size=result.surface.count))


def _with_one_tool(problem: Problem, kit: Kit, seed: int) -> Design:
    """Return the design with the best tool for all asperities; the choice ignores layout and `robust`."""
    found: dict[Tool, Design] = {}
    refused: dict[Tool, Infeasible] = {}
    objectives: list[tuple[Layout | None, Tolerances | None]] = [(None, None)]
    if problem.layout is not None or problem.robust is not None:
        objectives.append((problem.layout, problem.robust))
    tried = kit.tools
    for layout, robust in objectives:
        for tool in each("tool", tried):
            given = (
                problem.target,
                tool.on(problem.pins.template),
                problem.model,
                problem.limits,
                np.random.default_rng(seed),
            )
            try:
                found[tool] = design(*given, layout, robust=robust)
            except Infeasible as reason:
                refused[tool] = reason
        if not found:
            raise strategy.unreachable(refused)
        tried = (min(found, key=lambda tool: max(found[tool].misfit, EXACT)),)
    best = found[tried[0]]
    return replace(best, parameters={**best.parameters, **_kit_in_use(kit, best.surface)})


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
