"""Notes on a design that matter for making the part."""

from __future__ import annotations

from typing import Any

import numpy as np

from metafem.inversion.assessment import REACHED, DesignStatus, independent_misfit, misfit_meaning
from metafem.inversion.candidate import Blueprint, Branch
from metafem.inversion.limits import Limits
from metafem.inversion.problem import Request
from metafem.inversion.strategies.proportional import reached_line
from metafem.notes import Note
from metafem.prediction.friction_law import BranchFit
from metafem.surface import Surface

# Heights should be larger than the height errors by at least this factor.
HEIGHT_TO_ERROR = 10.0

# The heights count as restricted by max_height if they use all of their range but this fraction.
ALL_OF_IT = 1e-6


def design_notes(
    request: Request,
    blueprint: Blueprint,
    surface: Surface,
    fits: tuple[tuple[Branch, BranchFit], ...],
    misfit: float,
    status: DesignStatus,
) -> tuple[Note, ...]:
    """Return notes on a straight target that is missed, and on heights that are hard to make."""
    notes = _made(surface, request.limits, status)
    if misfit <= REACHED:
        return notes
    if blueprint.density is not None:
        return (*notes, _density(request, fits, misfit))
    if blueprint.branches and blueprint.wanted.pointwise and independent_misfit(blueprint) > REACHED:
        return (*notes, _line(request))
    return notes


def _density(request: Request, fits: tuple[tuple[Branch, BranchFit], ...], misfit: float) -> Note:
    """State the misfit of the density's heights, and that load_range makes the target a line."""
    name = request.target.wording.name(len(fits))
    return Note(
        f"{misfit_meaning(False, True, fits, misfit)}: {100.0 * misfit:.2g} %. The heights are those of a "
        f"density, whose law has the {name} at large loads and its own intercept. Give load_range: the "
        f"heights are then adjusted until friction is within {100.0 * REACHED:g} % of the line through the "
        "origin over those loads"
    )


def _line(request: Request) -> Note:
    """State over which loads the line is met."""
    target: Any = request.target
    wording = target.wording
    found = reached_line(target, request.radii, request.template.count, request.limits)
    if found is None or found.load_range is None:
        words = f"nor over any part of it; raise max_height or the {wording.name()}, or use a smaller radius"
    else:
        words = f"independent asperities meet it from {wording.inside(*found.load_range)}"
    ends = wording.loads(*target.load_range)
    return Note(f"the line is not met within {100.0 * REACHED:g} % from {ends}: {words}")


def _made(surface: Surface, limits: Limits, status: DesignStatus) -> tuple[Note, ...]:
    """State which heights are restricted by the limits, or hard to make."""
    notes: list[Note] = []
    used, step = float(np.ptp(surface.height)), limits.height_step or 0.0
    if status is DesignStatus.MISSED and used >= limits.span * (1.0 - ALL_OF_IT) - step:
        notes.append(Note(f"the heights use the whole allowed range of {limits.span:g} mm: raise max_height"))
    low = 0 if limits.height_sd is None else int((surface.height < HEIGHT_TO_ERROR * limits.height_sd).sum())
    if low:
        notes.append(
            Note(
                f"{low} of {surface.count} summits are lower than {HEIGHT_TO_ERROR:g} times height_sd = "
                f"{limits.height_sd:g} mm: raise the offset"
            )
        )
    return tuple(notes)
