"""Notes on a design that matter for manufacturing."""

from __future__ import annotations

from typing import Any

import numpy as np

from metafem._values import percent
from metafem.inversion.assessment import (
    MISSED,
    REACHED,
    DesignStatus,
    independent_misfit,
    misfit_text,
)
from metafem.inversion.candidate import Candidate
from metafem.inversion.limits import Limits
from metafem.inversion.problem import Problem
from metafem.inversion.result import Design
from metafem.inversion.strategies.proportional import reached_line
from metafem.notes import Level, Note, information

# Each height should be at least this many standard deviations of the height errors.
HEIGHT_TO_ERROR = 10.0

# Name of the number of summits below that.
LOW = "summits lower than the errors of their heights allow"

# The heights use the whole allowed range if they leave less than this fraction unused.
ALL_OF_IT = 1e-6


def design_notes(problem: Problem, candidate: Candidate, found: Design) -> tuple[Note, ...]:
    """Return all notes on a design: the notes on the candidate, on the heights and on the law.

    The notes on the heights state the effects of height steps and of prescribed heights, heights that are
    hard to manufacture, and the loads at which a missed line can be met.
    """
    limits, before, unpinned = problem.limits, candidate.unrounded, candidate.unpinned
    surface = found.surface
    notes = [] if before is None else [step_note(limits, before, found.misfit)]
    most = found.largest_misfit
    by_pins = unpinned is not None and unpinned <= most < found.misfit
    if unpinned is not None:
        notes.append(_pins(len(candidate.held), unpinned, found))
    allowed = limits.span if limits.height_step is None else float(np.ptp(limits.levels))
    by_steps = before is not None and before <= most
    full = float(np.ptp(surface.height)) >= allowed * (1.0 - ALL_OF_IT)
    held = full and found.status is DesignStatus.MISSED and not by_steps and not by_pins
    if held:
        steps = "" if limits.height_step is None else ", from the lowest to the highest step"
        words = f"the heights use the whole allowed range of {allowed:g} mm{steps}: raise max_height"
        notes.append(Note(words, remedies=("max_height",)))
    low = 0 if limits.height_sd is None else int((surface.height < HEIGHT_TO_ERROR * limits.height_sd).sum())
    if low:
        words = f"{low} of {surface.count} summits are lower than {HEIGHT_TO_ERROR:g} times height_sd"
        text = f"{words} = {limits.height_sd:g} mm: raise the offset"
        notes.append(Note(text, quantity=LOW, value=low, bound=0.0, remedies=("offset",)))
    if found.misfit > REACHED:
        law = candidate.target_law
        if candidate.density is not None:
            notes.append(_density(problem, found))
        elif (
            candidate.branches
            and law.pointwise
            and not by_pins
            and independent_misfit(problem, candidate) > REACHED
        ):
            notes.append(_line(problem, found.misfit, held))
    return tuple(dict.fromkeys((*candidate.notes, *notes, *found.law.notes)))


def _pins(count: int, unpinned: float, found: Design) -> Note:
    """Return a note on the misfits with and without `count` prescribed heights."""
    many = "the height of 1 site" if count == 1 else f"the heights of {count} sites"
    after, before = (misfit_text(misfit) for misfit in (found.misfit, unpinned))
    words = f"with {many} given the misfit is {after}; without, it is {before}"
    if found.status is not DesignStatus.MISSED or found.misfit <= unpinned:
        return information(words)
    text = f"{words}: give heights nearer to those designed without, or fewer of them"
    return Note(text, quantity="misfit", value=found.misfit, bound=unpinned, remedies=("pinned",))


def step_note(limits: Limits, before: float, after: float) -> Note:
    """Return the note that states the misfits before and after the rounding to height steps."""
    aside = ": the search over steps found a better law than that over free heights" if after < before else ""
    if after > REACHED >= before:
        aside = f"; a smaller height_step brings it below {percent(REACHED, 'g')}"
    return information(
        f"heights are on steps of {1e3 * (limits.height_step or 0.0):.4g} um: the misfit is "
        f"{misfit_text(after, 3)}; before rounding to them it was {misfit_text(before, 3)}{aside}"
    )


def _density(problem: Problem, found: Design) -> Note:
    """Return a note on the misfit of heights that follow a density; it recommends a load_range."""
    name, misfit = problem.target.wording.name(len(found.fits)), found.misfit
    return Note(
        f"the {found.misfit_meaning} is {misfit_text(misfit)}: the heights follow a density, whose law has "
        f"the {name} at large loads and its own intercept. Give load_range: heights are then found whose "
        f"friction is within {percent(REACHED, 'g')} of the line through the origin over those loads",
        Level.INFORMATION if misfit <= MISSED else Level.WARNING,
        "misfit", misfit, MISSED, ("load_range",),
    )  # fmt: skip


def _line(problem: Problem, misfit: float, held: bool) -> Note:
    """Return a note on the loads at which a line can be met with a misfit, with other remedies.

    `held` states whether max_height limits the heights.
    """
    target: Any = problem.target
    wording, found = target.wording, reached_line(target, problem)
    if found is None or found.load_range is None:
        height = "raise max_height or" if held else "raise"
        words = f"nor over any part of it; {height} the {wording.name()}, or use a smaller radius"
    else:
        inside = wording.inside(*found.load_range)
        words = (
            f"as the only range, {inside} can be met within {percent(REACHED, 'g')} (independent asperities)"
        )
    ends = wording.loads(*target.load_range)
    text = f"the line is not met within {percent(REACHED, 'g')} from {ends}: {words}"
    remedies = ("load_range", *("max_height",) * held)
    return Note(text, quantity="misfit", value=misfit, bound=REACHED, remedies=remedies)
