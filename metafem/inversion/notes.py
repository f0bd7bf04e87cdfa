"""Notes on a design: what limits it, what was left out, and what the next better model says of it."""

from __future__ import annotations

import numpy as np

from metafem._values import percent
from metafem.inversion.bounds import ROUNDING, nearest_law
from metafem.inversion.problem import Candidate, Problem
from metafem.inversion.refinement import MISSED, REACHED
from metafem.inversion.result import DOUBT, Design, DesignStatus, misfit_text
from metafem.models import Interacting
from metafem.models.model import contact_of
from metafem.notes import Level, Note, information
from metafem.substrate import BondedLayer, HalfSpace

# Each height should be at least this many standard deviations of the height errors.
HEIGHT_TO_ERROR = 10.0

# Name of the number of summits below that.
LOW = "summits lower than the errors of their heights allow"

# The heights use the whole allowed range if they leave less than this fraction unused.
ALL_OF_IT = 1e-6

# A design is judged by order 3 as well up to this number of asperities, which takes about a second.
JUDGED = 1000


def design_notes(problem: Problem, candidate: Candidate, found: Design) -> tuple[Note, ...]:
    """Return all notes on a design: the doubt of the next better model, then others."""
    notes = [*_doubt(problem, candidate, found), *candidate.notes, *_heights(problem, candidate, found)]
    missed = found.misfit > REACHED
    if missed and candidate.density is not None:
        notes.append(_of_density(problem, found))
    if found.misfit > found.largest_misfit and problem.held:
        words = f"{len(problem.held)} heights are given, and the misfit is {misfit_text(found.misfit)}"
        text = f"{words}: give others, or fewer"
        bound = found.largest_misfit
        notes.append(Note(text, quantity="misfit", value=found.misfit, bound=bound, remedies=("pinned",)))
    if problem.target.refused and not problem.target.exact and not candidate.law.is_band:
        notes += _outside(problem)
    return tuple(dict.fromkeys((*notes, *found.law.notes)))


def _heights(problem: Problem, candidate: Candidate, found: Design) -> list[Note]:
    """Return notes on height steps, on heights that use the whole range, and on summits that are too low."""
    limits, height, before, notes = problem.limits, found.surface.height, candidate.unrounded, list[Note]()
    if before is not None:
        aside = f"; a smaller height_step brings it below {percent(REACHED, 'g')}"
        notes.append(
            information(
                f"heights are on steps of {1e3 * (limits.height_step or 0.0):.4g} um: the misfit is "
                f"{misfit_text(found.misfit, 3)}; before rounding to them it was {misfit_text(before, 3)}"
                f"{aside if found.misfit > REACHED >= before else ''}"
            )
        )
    allowed = limits.span if limits.height_step is None else float(np.ptp(limits.levels))
    full = float(np.ptp(height)) >= allowed * (1.0 - ALL_OF_IT)
    if full and found.status is DesignStatus.MISSED and not (before is not None and before <= REACHED):
        words = f"the heights use the whole allowed range of {allowed:g} mm: raise max_height"
        notes.append(Note(words, remedies=("max_height",)))
    low = int((height < HEIGHT_TO_ERROR * (limits.height_sd or 0.0)).sum())
    if low:
        words = f"{low} of {len(height)} summits are lower than {HEIGHT_TO_ERROR:g} times height_sd"
        text = f"{words} = {limits.height_sd:g} mm: raise the offset"
        notes.append(Note(text, quantity=LOW, value=low, bound=0.0, remedies=("offset",)))
    return notes


def _doubt(problem: Problem, candidate: Candidate, found: Design) -> list[Note]:
    """Return a note if a design that meets its target misses it under the next better model."""
    model, surface, law = problem.model, found.surface, candidate.law
    on_block, better = problem.template.block is not None, model.reference
    same = model.couples and (not on_block or better.substrate != HalfSpace())
    judged = found.status is not DesignStatus.MISSED and problem.target.last_load is not None
    if same or not judged or not 1 < surface.count <= JUDGED:
        return []
    if on_block:
        better = Interacting(better.order, BondedLayer(), contact_of(model))
    curve = better.curve(surface, law.load)
    size = law.misfit(curve.area)
    if not curve.converged or size <= found.largest_misfit:
        return []
    difference = law.difference(curve.area)
    i = int(np.abs(difference).argmax())
    load = problem.target.wording.of_part(surface.material).loads(law.load[i], digits=3)
    where = "on the bonded layer" if on_block else "with interaction"
    off = f"{percent(abs(difference[i]), '.2g')} off {where} at {load}"
    text = f"{found.status.word} under the model {model.name}, but {off}"
    return [Note(text, quantity=DOUBT, value=size, bound=found.largest_misfit, remedies=("model",))]


def _outside(problem: Problem) -> list[Note]:
    """Return a note on samples that no surface meets."""
    law = problem.law
    distance, friction = nearest_law(law, problem.bounds, problem.margin)
    if distance <= ROUNDING:
        return []
    difference = np.abs(friction / law.lower - 1.0)
    most, many = int(difference.argmax()), int((difference > ROUNDING).sum())
    far = f"by up to {percent(float(difference[most]))} (sample {most + 1})"
    words = f"{many} of {len(difference)} differ from the nearest law within the bounds, {far}"
    return [
        information(f"no surface meets all samples: {words}; the design has the least rms difference found")
    ]


def _of_density(problem: Problem, found: Design) -> Note:
    """Return a note on the heights of a density that miss its law or the slopes."""
    name, within = problem.target.wording.name(len(found.fits)), percent(REACHED, "g")
    text = (
        f"the {found.misfit_meaning} is {misfit_text(found.misfit)}: the law sought is that of a density of "
        f"heights, with the {name} at large loads and an intercept. Give load_range: heights are then found "
        f"with a friction within {within} of the line through the origin over those loads"
    )
    level = Level.INFORMATION if found.misfit <= MISSED else Level.WARNING
    return Note(text, level, "misfit", found.misfit, MISSED, ("load_range",))
