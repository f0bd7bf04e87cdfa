"""Heights of interacting asperities whose contacts form at the same loads as for independent ones.

With laws other than Hertz's, A0(P) has a sharper kink where a contact forms. Interaction shifts the kinks,
and gradients are not valid beyond them. The unknowns are therefore the heights of independent asperities,
shifted so that each summit first touches at the same loads of the others.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from metafem._validate import FloatArray
from metafem.contact.law import contacts
from metafem.errors import InvalidInput
from metafem.inversion.candidate import Candidate, below_limit
from metafem.inversion.problem import Problem
from metafem.inversion.search.levenberg_marquardt import Minimum, descend, search
from metafem.inversion.search.nearest_law import beyond
from metafem.inversion.search.spaces import Heights, LateResidual
from metafem.models import Independent

# Maximum number of loads of the target that are used.
LOADS = 30

# Maximum number of descent steps for interacting adhesive asperities: each takes a tenth of a second to a
# second.
ADHESIVE_STEPS = 6


def with_same_entries(problem: Problem, start: Candidate, goal: float, rng: np.random.Generator) -> Minimum:
    """Return heights whose law under the model meets the target, with its misfit.

    The unknowns are heights of independent asperities, whose gradients are used; the law is that of the
    shifted heights under the model. With adhesion, each step is slow, so their number is limited.
    """
    solver, limits, options = problem.model.gradient_model, problem.limits, problem.options
    law, surface = start.target_law.thinned(LOADS), start.surface(problem.template)
    space = Heights(limits.span)
    independent, shifted = Independent(contact=problem.contact), shift(problem, start)
    nothing = beyond(law.load, start.height)

    def residual(height: FloatArray) -> LateResidual:
        try:
            found = independent.sensitivity_of(height, surface.radius, law.load)
            given = below_limit(shifted(height), limits)
            area = solver.areas(surface, law.load, given[None])[0]
        except InvalidInput:
            return nothing
        return law.late_residual(area, lambda: found.gradient) if np.isfinite(area).all() else nothing

    if problem.contact.adhesive:
        options = replace(options, most_steps=ADHESIVE_STEPS, most_exact_steps=ADHESIVE_STEPS)
    if start.lowest_level is not None:
        found = descend(residual, start.height, space, goal, True, options)
    else:
        restarts = 0 if problem.contact.adhesive else problem.effort.refined_restarts
        found = search(residual, [start.height], space, goal, restarts, rng, options)
    return replace(found, unknowns=shifted(found.unknowns))


def shift(problem: Problem, start: Candidate) -> Callable[[FloatArray], FloatArray]:
    """Return the function that shifts heights (n,) [mm] of independent asperities for the interaction.

    When the plane touches summit i of independent asperities, the loads P_j of the others follow from their
    indentations h_j - h_i. Their field ``u = sum K P_j/E*`` lowers summit i and the others. With the height
    ``h_i + u_i + <h'_j - h_j - u_j>``, in the order of the heights, summit i is touched at the same loads of
    the others. The mean is weighted by their stiffness.
    """
    radius, deepest = start.radius, problem.contact.largest_indentation(start.radius)
    substrate = problem.model.reference.substrate
    influence = substrate.influence_matrix(start.surface(problem.template))

    def shifted(height: FloatArray) -> FloatArray:
        depth = np.clip(height - height[:, None], 0.0, deepest)
        found = contacts(problem.contact, depth, np.broadcast_to(radius, depth.shape))
        closed = depth > 0.0
        field = np.where(closed, found.load, 0.0) @ influence
        stiffness, moved = np.where(closed, found.stiffness, 0.0), np.zeros(len(height))
        order = np.argsort(-height, kind="stable")
        for k, i in enumerate(order[1:], start=1):
            above = order[:k]
            total = stiffness[i, above].sum()
            if total > 0.0:
                others = (moved[above] - field[i, above]) @ stiffness[i, above] / total
                moved[i] = field[i, i] + others
        return height + moved

    return shifted
