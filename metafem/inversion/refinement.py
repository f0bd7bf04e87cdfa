"""Heights of independent asperities, refined until their law under another model meets the target."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.assessment import MISSED, branch_fits, independent_misfit, largest_misfit
from metafem.inversion.candidate import Blueprint
from metafem.inversion.problem import Request
from metafem.inversion.search.levenberg_marquardt import (
    POINT_GOAL,
    Evaluate,
    Heights,
    Refined,
    descend,
    search,
)
from metafem.inversion.search.multistart import GOAL, law_of_heights
from metafem.inversion.targets.wanted import Wanted
from metafem.models import Independent
from metafem.notes import Note, information
from metafem.progress import doing, each
from metafem.surface import Surface

# Factors on the summit depths, so that no level first touches exactly at an operating point: interaction
# lowers open summits by a hundredth to a tenth of their depth.
STRETCHES = (1.03, 1.0, 1.06, 1.1)

# Depth of the added summits below the last level, relative to the depth of that level.
FILL = 0.01

# Misfit at which the search under an interacting model ends. It is a little above that of the first search,
# because the scatter from single contacts that enter remains.
REFINED_GOAL = 9e-4

# Up to this misfit the heights of the independent inversion are the only initial guess.
CLOSE = 5.0 * REFINED_GOAL

# Random restarts under an interacting model, whose descents cost ten times those of independent asperities.
RESTARTS = 3

# Degree of the polynomial in the logarithm of the load that fits A0(model)/A0(independent). A low degree
# leaves out the kinks of single contacts, which move with the heights.
FACTOR_DEGREE = 3

# Random restarts with independent asperities for the compensated law, about 3 ms each.
CHEAP_RESTARTS = 10

# Loads at which the interaction margin is computed, as fractions of the target's last load.
MARGIN_SHARES = np.array([0.25, 0.5, 1.0])


@doing("refining the heights under the model")
def refined_surface(
    request: Request, surface: Surface, sites: IntArray, blueprint: Blueprint, rng: np.random.Generator
) -> tuple[Surface, IntArray, tuple[Note, ...]]:
    """Return the surface with heights refined under the model, its sites, and a note on the change.

    Heights on steps are not changed. Heights of independent asperities are changed only where those of a
    density miss its law. For a model without gradients the heights are refined under its `gradient_model`,
    and the last steps use its gradients with the law of the model itself.
    """
    model, limits, wanted = request.model, request.limits, blueprint.wanted
    if blueprint.stepped:
        return surface, sites, ()
    alone = not model.couples
    unrefined = independent_misfit(blueprint) if alone and blueprint.density is not None else 0.0
    if alone and unrefined <= MISSED:
        return surface, sites, ()
    solver = model.gradient_model
    start, added = surface, ""
    if blueprint.spare_height is not None:
        start, sites = _filled(surface, sites, request.template, blueprint.spare_height)
        if start.count > surface.count:
            added = f", and {start.count - surface.count} asperities were added to raise the friction"

    def evaluate(height: FloatArray) -> tuple[FloatArray, FloatArray]:
        found = solver.sensitivity(start.replaced(height=height), wanted.load)
        return found.curve.area, found.gradient

    def evaluate_model(height: FloatArray) -> tuple[FloatArray, FloatArray]:
        area = model.curve(start.replaced(height=height), wanted.load).area
        return area, evaluate(height)[1]

    if blueprint.exact:
        found = _through_points(evaluate, start.height, wanted, limits.span)
    else:
        space = Heights(limits.span)
        starts = [start.height]
        if wanted.misfit(evaluate(start.height)[0]) > CLOSE:
            # heights whose sites were chosen for this model should change as little as possible
            starts.insert(
                0 if request.layout is None else 1, _compensated(start, evaluate, wanted, space, rng)
            )
        found = search(evaluate, starts, wanted, space, REFINED_GOAL, RESTARTS, rng)
    if solver != model:
        goal = POINT_GOAL if blueprint.exact else REFINED_GOAL
        found = descend(evaluate_model, found.unknowns, wanted, Heights(limits.span), goal)
    height = limits.offset + limits.max_height - (found.unknowns.max() - found.unknowns)
    result = start.replaced(height=np.maximum(height, limits.foot))
    if alone and largest_misfit(result, model, blueprint, branch_fits(result, model, blueprint)) >= unrefined:
        return surface, sites, ()
    change = 1e3 * float(np.abs(result.height - start.height).max())
    cause = "the scatter of so few asperities" if alone else "the interaction of the asperities"
    under = "" if solver == model else f"; the gradients were those of the model {solver.name}"
    note = f"heights were moved by at most {change:.3g} um for {cause}{added}{under}"
    return result, sites, (information(note),)


def _compensated(
    surface: Surface, coupled: Evaluate, wanted: Wanted, space: Heights, rng: np.random.Generator
) -> FloatArray:
    """Return heights whose independent law is the target divided by A0(model)/A0(independent).

    That ratio is a smooth function of the load and depends little on small changes of the heights.
    """
    evaluate = law_of_heights(surface.radius, wanted.load)
    area = coupled(surface.height)[0]
    factor = area / evaluate(surface.height)[0]
    powers = np.vander(np.log(wanted.load / wanted.load[-1]), FACTOR_DEGREE + 1)
    smooth = powers @ np.linalg.lstsq(powers, factor, rcond=None)[0]
    law = Wanted.exactly(wanted.load, wanted.law(area) / smooth, wanted.weight)
    return search(evaluate, [surface.height], law, space, GOAL, CHEAP_RESTARTS, rng).unknowns


def _filled(
    surface: Surface, sites: IntArray, template: Surface, spare_height: float
) -> tuple[Surface, IntArray]:
    """Return the surface with summits on all sites of the template, new ones just below a height.

    Interaction lowers the friction at every point. Without added summits only an earlier contact of the
    levels could raise it. The added summits have the radius of the lowest summit.
    """
    height = np.full(template.count, spare_height - FILL * (float(surface.height.max()) - spare_height))
    radius = np.full(template.count, surface.radius[surface.height.argmin()])
    height[sites], radius[sites] = surface.height, surface.radius
    return template.replaced(height=height, radius=radius), np.arange(template.count)


def _through_points(evaluate: Evaluate, height: FloatArray, wanted: Wanted, span: float) -> Refined:
    """Meet the points exactly, from heights moved off the kinks where a level first touches at a point."""
    best: Refined | None = None
    for stretch in each("start", STRETCHES, at_most=True):
        start = height.max() - np.minimum(stretch * (height.max() - height), span)
        found = descend(evaluate, start, wanted, Heights(span), POINT_GOAL, patient=True)
        best = found if best is None or found.misfit < best.misfit else best
        if best.misfit <= POINT_GOAL:
            break
    return best if best is not None else Refined(height, np.inf)


def interaction_margin(request: Request) -> float:
    """Return twice the largest relative change of A0 of equal heights by interaction.

    The change is taken up to the last load of the target. Bounds that are proven for independent
    asperities are enforced only beyond this margin.
    """
    template, model = request.template.replaced(radius=request.radii.high), request.model
    if not model.couples or template.count == 1 or request.target.last_load is None:
        return 0.0
    equal = template.replaced(height=np.zeros(template.count))
    load = request.target.last_load * MARGIN_SHARES
    change = model.curve(equal, load).area / Independent().curve(equal, load).area - 1.0
    return 2.0 * float(np.abs(change).max())
