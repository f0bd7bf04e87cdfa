"""What a user should know of a design before making the part."""

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

# Heights should be this many times larger than the errors with which they are made.
HEIGHT_TO_ERROR = 10.0

# Heights that differ by all but this share of what they may are held back by it.
ALL_OF_IT = 1e-6


def design_notes(
    request: Request,
    blueprint: Blueprint,
    surface: Surface,
    fits: tuple[tuple[Branch, BranchFit], ...],
    misfit: float,
    status: DesignStatus,
) -> tuple[Note, ...]:
    """Return what is wrong with a design: a straight target that is missed, and heights hard to make."""
    notes = _made(surface, request.limits, status)
    if misfit <= REACHED:
        return notes
    if blueprint.density is not None:
        return (*notes, _density(request, fits, misfit))
    if blueprint.branches and blueprint.wanted.pointwise and independent_misfit(blueprint) > REACHED:
        return (*notes, _line(request))
    return notes


def _density(request: Request, fits: tuple[tuple[Branch, BranchFit], ...], misfit: float) -> Note:
    """Say how far the law of a density's heights is off, and that a line can be asked for."""
    name = request.target.wording.name(len(fits))
    return Note(
        f"{misfit_meaning(False, True, fits, misfit)}: {100.0 * misfit:.2g} %. The heights are those of a "
        f"density, whose law has the {name} at large loads and an intercept of its own. Give load_range: the "
        f"heights are then moved until friction is within {100.0 * REACHED:g} % of the line through the "
        "origin over those loads"
    )


def _line(request: Request) -> Note:
    """Say over which loads the line is met instead."""
    target: Any = request.target
    wording = target.wording
    found = reached_line(target, request.radii, request.template.count, request.limits)
    if found is None or found.load_range is None:
        words = f"no part of this range is; raise max_height or the {wording.name()}, or use a smaller radius"
    else:
        words = f"from {wording.inside(*found.load_range)} it is, for independent asperities"
    ends = wording.loads(*target.load_range)
    return Note(f"the line is not met within {100.0 * REACHED:g} % from {ends}: {words}")


def _made(surface: Surface, limits: Limits, status: DesignStatus) -> tuple[Note, ...]:
    """Say which heights hold a law back, or are hard to make."""
    notes: list[Note] = []
    used, step = float(np.ptp(surface.height)), limits.height_step or 0.0
    if status is DesignStatus.MISSED and used >= limits.span * (1.0 - ALL_OF_IT) - step:
        notes.append(
            Note(f"the heights use all of the {limits.span:g} mm that they may differ by: raise max_height")
        )
    low = 0 if limits.height_sd is None else int((surface.height < HEIGHT_TO_ERROR * limits.height_sd).sum())
    if low:
        notes.append(
            Note(
                f"{low} of {surface.count} summits stand lower than {HEIGHT_TO_ERROR:g} times height_sd = "
                f"{limits.height_sd:g} mm: raise the offset"
            )
        )
    return tuple(notes)
