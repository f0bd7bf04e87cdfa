"""Heights found for independent asperities, adapted to another model on their places."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.blueprint import Blueprint
from metafem.inversion.judge import UNCOUPLED
from metafem.inversion.limits import Limits
from metafem.inversion.nearest import GOAL, independent_law
from metafem.inversion.refine import POINT_GOAL, Evaluate, Heights, Refined, descend, search
from metafem.inversion.wanted import Wanted
from metafem.models import Independent, Model, Sensitive
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

# Loads at which the margin of interaction is taken, in shares of the load that closes all contacts.
MARGIN_SHARES = np.array([0.25, 1.0])


def adapted(
    surface: Surface,
    sites: IntArray,
    template: Surface,
    model: Model,
    blueprint: Blueprint,
    limits: Limits,
    rng: np.random.Generator,
) -> tuple[Surface, IntArray, tuple[str, ...]]:
    """Return the surface with heights refined under the model, its sites, and a note that says so.

    Heights that stand on steps already stay there, and models without sensitivities leave them as they are.
    """
    if isinstance(model, UNCOUPLED) or not isinstance(model, Sensitive) or blueprint.stepped:
        return surface, sites, ()
    solver: Sensitive = model
    start = surface
    if blueprint.spare_height is not None:
        start, sites = _filled(surface, sites, template, blueprint.spare_height)

    def evaluate(height: FloatArray) -> tuple[FloatArray, FloatArray]:
        found = solver.sensitivity(start.replaced(height=height), blueprint.wanted.load)
        return found.curve.area, found.gradient

    if blueprint.exact:
        found = _through_points(evaluate, start.height, blueprint.wanted, limits.span)
    else:
        space = Heights(limits.span)
        starts = [start.height]
        if blueprint.wanted.misfit(model.curve(start, blueprint.wanted.load).area) > CLOSE:
            starts.insert(0, _forestalled(start, model, blueprint.wanted, space, rng))
        found = search(evaluate, starts, blueprint.wanted, space, ADAPTED_GOAL, RESTARTS, rng)
    top = limits.offset + limits.max_height
    result = start.replaced(height=top - (found.unknowns.max() - found.unknowns))
    change = 1e3 * float(np.abs(result.height - start.height).max())
    note = f"heights were moved by at most {change:.3g} um for the interaction of the asperities"
    return result, sites, (note,)


def _forestalled(
    surface: Surface, model: Model, wanted: Wanted, space: Heights, rng: np.random.Generator
) -> FloatArray:
    """Return heights whose independent law has more where interaction takes, and less where it gives.

    Interaction changes a law by a smooth factor that hardly depends on small changes of the heights.
    """

    def evaluate(height: FloatArray) -> tuple[FloatArray, FloatArray]:
        found = independent_law(height, surface.radius, wanted.load)
        return found.curve.area, found.gradient

    area = model.curve(surface, wanted.load).area
    factor = area / evaluate(surface.height)[0]
    logarithm, degree = np.log(wanted.load), min(FACTOR_DEGREE, len(wanted.load) - 1)
    smooth = np.polyval(np.polyfit(logarithm, factor, degree), logarithm)
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
    for stretch in STRETCHES:
        start = height.max() - np.minimum(stretch * (height.max() - height), span)
        found = descend(evaluate, start, wanted, Heights(span), POINT_GOAL, patient=True)
        best = found if best is None or found.misfit < best.misfit else best
        if best.misfit <= POINT_GOAL:
            break
    return best if best is not None else Refined(height, np.inf)


def interaction_margin(template: Surface, model: Model) -> float:
    """Return how much interaction changes A0 of the template with equal heights, relative.

    Bounds that are proven for independent asperities are enforced only beyond twice that.
    """
    if isinstance(model, UNCOUPLED) or template.count == 1:
        return 0.0
    equal = template.replaced(height=np.zeros(template.count))
    # indentation to a/R = 0.2, within the range of all models
    depth = 0.04 * float(template.radius.min())
    load = Independent().curve_at(equal, np.array([depth])).load[0] * MARGIN_SHARES
    change = model.curve(equal, load).area / Independent().curve(equal, load).area - 1.0
    return 2.0 * float(np.abs(change).max())
