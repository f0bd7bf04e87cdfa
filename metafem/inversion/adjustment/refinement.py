"""Refinement of heights of independent asperities until their law under another model meets the target.

With contact laws other than Hertz's law, A0(P) has a sharper kink where a contact forms. Interaction shifts
the kinks, and gradients are not valid beyond a kink. The unknowns in `with_same_entries` are therefore the
heights of independent asperities. These heights are then shifted so that, with interaction, each summit first
touches at the same loads on the other summits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np

from metafem._validate import FloatArray
from metafem.contact.law import contacts
from metafem.errors import InvalidInput
from metafem.inversion.assessment import EXACT, MISSED, POINT_GOAL, independent_misfit, model_misfit
from metafem.inversion.candidate import Candidate, below_limit
from metafem.inversion.problem import Problem
from metafem.inversion.search.asperities import beyond
from metafem.inversion.search.levenberg_marquardt import Minimum, descend, search
from metafem.inversion.search.nearest_law import GOAL, residual_of_surface
from metafem.inversion.search.spaces import Heights, LateResidual, Residual
from metafem.inversion.search.target_law import TargetLaw
from metafem.models import Independent, Sensitivity
from metafem.models.model import contact_of, has_paraboloids
from metafem.notes import information
from metafem.progress import doing

# Misfit at which the search ends. It is slightly above that of the independent search, because scatter from
# single new contacts remains.
REFINED_GOAL = 9e-4

# If descents for operating points end above this misfit, at kinks of the law, random changes follow.
AT_KINKS = 1e-3

# Up to this misfit, the heights of the independent inversion are the only initial guess.
CLOSE = 5.0 * REFINED_GOAL

# Number of restarts with adhesion.
ADHESIVE_RESTARTS = 1

# Degree of the polynomial in ln P that is fitted to A0(model)/A0(independent). A low degree smooths out the
# kinks of single contacts, which move with the heights.
RATIO_DEGREE = 3

# Maximum number of loads of the target in `with_same_entries`.
LOADS = 30

# Maximum number of descent steps for interacting adhesive asperities: each takes a tenth of a second to a
# second.
ADHESIVE_STEPS = 6

# Factors for the summit depths in initial guesses, so that no level first touches exactly at an operating
# point. Interaction lowers open summits by between a hundredth and a tenth of their depth.
STRETCHES = (1.03, 1.0, 1.06, 1.1)

# Depth of the added summits below the lowest level, relative to the depth of that level.
ADDED_DEPTH = 0.01


def refined(problem: Problem, candidate: Candidate, rng: np.random.Generator) -> Candidate:
    """Return the candidate with heights refined under the model, and a note on the change.

    Heights on steps do not change. For independent asperities, heights change only if they follow a density
    and miss its law; the law of a density is that without adhesion. If the model has no gradients, the
    heights are refined under its `gradient_model`, and the last steps combine these gradients with the law of
    the model itself. Adhesive heights of a density are first refined without interaction, which takes a
    hundredth of the time.
    """
    model, limits = problem.model, problem.limits
    options = replace(problem.options, most_exact_steps=problem.effort.refined_steps)
    # a density has heights for independent asperities without adhesion
    sticking = problem.contact.adhesive and candidate.density is not None
    moved = model.couples or sticking
    if candidate.stepped or not (moved or candidate.density is not None):
        return candidate
    unrefined = np.inf if moved else independent_misfit(problem, candidate)
    if unrefined <= MISSED:
        return candidate
    if model.couples and sticking:
        uncoupled = replace(problem, model=Independent(contact=problem.contact))
        candidate = refined(uncoupled, candidate, rng)
    with doing("refining the heights under the model"):
        solver, space = model.gradient_model, Heights(limits.span)
        best, start = Minimum(candidate.height, np.inf), candidate
        for trial in (filled(candidate, problem), candidate):
            exact = trial.lowest_level is not None
            goal = max(POINT_GOAL if exact else REFINED_GOAL, problem.effort.refined_goal)
            law = trial.target_law if exact else trial.target_law.thinned(problem.effort.refined_loads)
            searched = replace(trial, target_law=law)
            first, residual, residual_of_model = residuals(
                problem, searched, lambda height: below_limit(height, limits)
            )
            if model.couples and not has_paraboloids(model):
                found = with_same_entries(problem, trial, goal, rng)
                if found.misfit > goal and not problem.contact.adhesive:
                    found = descend(residual, found.unknowns, space, goal, exact, options)
            elif exact:
                guesses = stretched(trial.height, limits.span)[: problem.effort.refined_guesses]
                found = search(residual, guesses, space, goal, 0, rng, options, to_rounding=True)
                changes = problem.effort.refined_restarts
                if changes and found.misfit > AT_KINKS:
                    found = search(residual, [found.unknowns], space, AT_KINKS, changes, rng, options)
                    found = descend(residual, found.unknowns, space, goal, True, options)
            else:
                guesses = _initial_guesses(problem, searched, first().curve.area, rng)
                restarts = ADHESIVE_RESTARTS if problem.contact.adhesive else problem.effort.refined_restarts
                found = search(residual, guesses, space, goal, restarts, rng, options)
            if solver != model:
                found = descend(residual_of_model, found.unknowns, space, goal, options=options)
            best, start = (found, trial) if found.misfit < best.misfit else (best, start)
            if best.misfit <= max(EXACT, goal) or len(trial.height) == len(candidate.height):
                break
        result = start.with_heights(below_limit(best.unknowns, limits))
        if not moved and model_misfit(problem, result) >= unrefined:
            return candidate
    change = 1e3 * float(np.abs(result.height - start.height).max())
    added = len(start.height) - len(candidate.height)
    if change == 0.0 and not added:
        return candidate
    cause = "the interaction of the asperities" if model.couples else "the scatter of so few asperities"
    if problem.contact.adhesive and not model.couples:
        cause = "the adhesion of the asperities"
    more = f", and {added} asperities were added to raise the friction" if added else ""
    under = "" if solver == model else f"; the gradients were those of the model {solver.name}"
    note = information(f"heights were moved by at most {change:.3g} um for {cause}{more}{under}")
    return replace(result, notes=(*candidate.notes, note))


def residuals(
    problem: Problem, start: Candidate, placed: Callable[[FloatArray], FloatArray]
) -> tuple[Callable[[], Sensitivity], Residual, Residual]:
    """Return a function for the sensitivity of a candidate's heights, and two residual functions.

    The residual functions are those under the gradient model and under the model itself. The sensitivity is
    computed only once. `placed` maps heights to allowed heights.
    """
    model, law = problem.model, start.target_law
    solver, surface = model.gradient_model, start.surface(problem.template)

    @cache
    def first() -> Sensitivity:
        return solver.sensitivity(surface, law.load, placed(start.height))

    def residual(height: FloatArray) -> LateResidual:
        same = np.array_equal(height, start.height)
        try:
            found = first() if same else solver.sensitivity(surface, law.load, placed(height))
        except InvalidInput:
            return beyond(law.load, height)
        return law.late_residual(found.curve.area, lambda: found.gradient)

    def residual_of_model(height: FloatArray) -> LateResidual:
        height = placed(height)
        area = model.curve(surface.replaced(height=height), law.load).area
        return law.late_residual(area, lambda: solver.sensitivity(surface, law.load, height).gradient)

    return first, residual, residual_of_model


def _initial_guesses(
    problem: Problem, start: Candidate, area: FloatArray, rng: np.random.Generator
) -> list[FloatArray]:
    """Return the heights of a candidate and, if their A0 (k,) is far from the target, corrected heights.

    The independent law of the corrected heights is the target divided by A0(model)/A0(independent). This
    ratio is a smooth function of the load and depends little on small changes of the heights.
    """
    law, surface = start.target_law, start.surface(problem.template)
    if law.misfit(area) <= CLOSE:
        return [start.height]
    ratio = area / problem.uncoupled.curve(surface, law.load).area
    powers = np.vander(np.log(law.load / law.load[-1]), RATIO_DEGREE + 1)
    smooth = powers @ np.linalg.lstsq(powers, ratio, rcond=None)[0]
    divided = TargetLaw.fixed(law.load, law.law(area) / smooth, law.weight)
    residual = residual_of_surface(problem.uncoupled, surface, divided)
    space, restarts = Heights(problem.limits.span), problem.effort.ratio_restarts
    corrected = search(residual, [surface.height], space, GOAL, restarts, rng, problem.options)
    return [corrected.unknowns, start.height]


def filled(candidate: Candidate, problem: Problem) -> Candidate:
    """Return the candidate with summits on all sites; the added summits are just below the lowest level.

    Interaction lowers the friction at every operating point. Without added summits, the friction could rise
    only if levels came into contact earlier. Added summits that are not needed can mislead the descent,
    however. The added summits have the radius and the cap of the lowest summit.
    """
    if candidate.lowest_level is None:
        return candidate
    count, lowest = problem.count, candidate.lowest_level
    depth = ADDED_DEPTH * (float(candidate.height.max()) - lowest)
    height, rows = np.full(count, lowest - depth), np.full(count, candidate.height.argmin())
    height[candidate.sites], rows[candidate.sites] = candidate.height, np.arange(len(candidate.height))
    return replace(candidate.taken(rows), height=height, sites=np.arange(count))


def stretched(height: FloatArray, span: float = np.inf) -> list[FloatArray]:
    """Return heights moved off the kinks of the law, at which a level first touches; (n,) for each guess."""
    depth = height.max() - height
    return [height.max() - np.minimum(stretch * depth, span) for stretch in STRETCHES]


def with_same_entries(problem: Problem, start: Candidate, goal: float, rng: np.random.Generator) -> Minimum:
    """Return heights whose law under the model is near the target, with their misfit.

    The unknowns are heights of independent asperities. Their gradients are those of independent asperities,
    but the law is that of the shifted heights under the model. With adhesion the steps are slow, and their
    number is limited.
    """
    solver, limits, options = problem.model.gradient_model, problem.limits, problem.options
    law, surface = start.target_law.thinned(LOADS), start.surface(problem.template)
    space = Heights(limits.span)
    shifted = shift(problem, start)
    nothing = beyond(law.load, start.height)

    def residual(height: FloatArray) -> LateResidual:
        try:
            found = problem.uncoupled.sensitivity(surface, law.load, height)
            given = below_limit(shifted(height), limits)
            area = solver.areas(surface, law.load, given[None])[0]
        except InvalidInput:
            return nothing
        return law.late_residual(area, lambda: found.gradient) if np.isfinite(area).all() else nothing

    if problem.contact.adhesive:
        options = replace(options, most_steps=ADHESIVE_STEPS, most_exact_steps=ADHESIVE_STEPS)
    exact = start.lowest_level is not None
    restarts = 0 if exact or problem.contact.adhesive else problem.effort.refined_restarts
    found = search(residual, [start.height], space, goal, restarts, rng, options, exact)
    return replace(found, unknowns=shifted(found.unknowns))


def shift(problem: Problem, start: Candidate) -> Callable[[FloatArray], FloatArray]:
    """Return a function that corrects heights (n,) [mm] of independent asperities for interaction.

    When the plane touches summit i of independent asperities, the loads P_j of the higher asperities follow
    from their indentations h_j - h_i. The displacement ``u = sum K P_j/E*`` due to these loads lowers summit
    i by u_i and the higher summits by u_j. With the corrected height
    ``h'_i = h_i + u_i + <h'_j - h_j - u_j>`` the plane touches summit i at the same loads P_j. The mean is
    weighted by the contact stiffnesses of the higher asperities. The corrected heights are computed from the
    tallest to the lowest.
    """
    surface = start.surface(problem.template)
    law = contact_of(problem.model).bound(surface)
    summits = law.summits(surface)
    deepest = law.largest_indentation(summits)
    influence = problem.model.reference.substrate.influence_matrix(surface)

    def shifted(height: FloatArray) -> FloatArray:
        depth = np.clip(height - height[:, None], 0.0, deepest)
        found = contacts(law, depth, np.broadcast_to(summits, depth.shape))
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
