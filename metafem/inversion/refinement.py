"""Heights found for independent asperities, adapted to another model on their places."""

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

# Depths below the tallest are stretched, so that no level touches just at a point: interaction lowers
# free summits by a hundredth to a tenth of their depth.
STRETCHES = (1.03, 1.0, 1.06, 1.1)

# Depth of spare summits below the last level, in the last level's own depth.
FILL = 0.01

# Misfit at which the search under an interacting model ends, a little above that of the first search:
# its own noise of entering contacts is left.
ADAPTED_GOAL = 9e-4

# A law this near needs no other start than its own heights.
CLOSE = 5.0 * ADAPTED_GOAL

# Random restarts under an interacting model, whose descents cost ten times those of the independent one.
RESTARTS = 3

# The factor by which interaction changes a law, as a polynomial of the logarithm of the load: without
# the jags of single contacts, which heights that are moved no longer have.
FACTOR_DEGREE = 3

# Random restarts of the independent descents for it, of some 3 ms each.
CHEAP_RESTARTS = 10

# Loads at which the margin of interaction is taken, in shares of the last one asked for.
MARGIN_SHARES = np.array([0.25, 0.5, 1.0])


@doing("refining the heights under the model")
def adapted(
    request: Request, surface: Surface, sites: IntArray, blueprint: Blueprint, rng: np.random.Generator
) -> tuple[Surface, IntArray, tuple[Note, ...]]:
    """Return the surface with heights refined under the model, its sites, and a note that says so.

    Heights that stand on steps already stay there, and so do those of independent asperities unless those
    of a density miss its law. A model without gradients uses those of its `gradient_model`: the heights are
    refined under that one, and in the last steps under the model itself.
    """
    model, limits, wanted = request.model, request.limits, blueprint.wanted
    if blueprint.stepped:
        return surface, sites, ()
    alone = not model.couples
    dealt = independent_misfit(blueprint) if alone and blueprint.density is not None else 0.0
    if alone and dealt <= MISSED:
        return surface, sites, ()
    solver = model.gradient_model
    start, added = surface, ""
    if blueprint.spare_height is not None:
        start, sites = _filled(surface, sites, request.template, blueprint.spare_height)
        if start.count > surface.count:
            added = f", and {start.count - surface.count} asperities were added that give friction back"

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
            # heights whose places were chosen for this model are moved as little as can be
            starts.insert(
                0 if request.layout is None else 1, _forestalled(start, evaluate, wanted, space, rng)
            )
        found = search(evaluate, starts, wanted, space, ADAPTED_GOAL, RESTARTS, rng)
    if solver != model:
        goal = POINT_GOAL if blueprint.exact else ADAPTED_GOAL
        found = descend(evaluate_model, found.unknowns, wanted, Heights(limits.span), goal)
    height = limits.offset + limits.max_height - (found.unknowns.max() - found.unknowns)
    result = start.replaced(height=np.maximum(height, limits.foot))
    if alone and largest_misfit(result, model, blueprint, branch_fits(result, model, blueprint)) >= dealt:
        return surface, sites, ()
    change = 1e3 * float(np.abs(result.height - start.height).max())
    cause = "the scatter of so few asperities" if alone else "the interaction of the asperities"
    under = "" if solver == model else f"; the gradients were those of the model {solver.name}"
    note = f"heights were moved by at most {change:.3g} um for {cause}{added}{under}"
    return result, sites, (information(note),)


def _forestalled(
    surface: Surface, coupled: Evaluate, wanted: Wanted, space: Heights, rng: np.random.Generator
) -> FloatArray:
    """Return heights whose independent law has more where interaction takes, and less where it gives.

    Interaction changes a law by a smooth factor that hardly depends on small changes of the heights.
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
    """Return the surface with summits on all places of the template, new ones just below a height.

    Interaction takes friction at every point; without spare asperities the levels could only give it
    back by reaching into contact before their point. They have the lowest summit's radius.
    """
    height = np.full(template.count, spare_height - FILL * (float(surface.height.max()) - spare_height))
    radius = np.full(template.count, surface.radius[surface.height.argmin()])
    height[sites], radius[sites] = surface.height, surface.radius
    return template.replaced(height=height, radius=radius), np.arange(template.count)


def _through_points(evaluate: Evaluate, height: FloatArray, wanted: Wanted, span: float) -> Refined:
    """Meet points exactly. Each level just touches at the point before it: its kink must be left first."""
    best: Refined | None = None
    for stretch in each("start", STRETCHES, at_most=True):
        start = height.max() - np.minimum(stretch * (height.max() - height), span)
        found = descend(evaluate, start, wanted, Heights(span), POINT_GOAL, patient=True)
        best = found if best is None or found.misfit < best.misfit else best
        if best.misfit <= POINT_GOAL:
            break
    return best if best is not None else Refined(height, np.inf)


def interaction_margin(request: Request) -> float:
    """Return how much interaction changes A0 of equal heights up to the last load asked for, relative.

    Bounds that are proven for independent asperities are enforced only beyond twice that.
    """
    template, model = request.template.replaced(radius=request.radii.high), request.model
    if not model.couples or template.count == 1 or request.target.last_load is None:
        return 0.0
    equal = template.replaced(height=np.zeros(template.count))
    load = request.target.last_load * MARGIN_SHARES
    change = model.curve(equal, load).area / Independent().curve(equal, load).area - 1.0
    return 2.0 * float(np.abs(change).max())
