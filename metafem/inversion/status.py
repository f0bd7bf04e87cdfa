"""Status of a design, and its misfit in words."""

from __future__ import annotations

from enum import Enum

from metafem._values import percent
from metafem.inversion.refinement import EXACT, MISSED, REACHED

# Number of digits that identify any double-precision number.
MOST_DIGITS = 17


class DesignStatus(Enum):
    """Status of a design; the value is the message."""

    EXACT = "exact: the law meets the target to 1e-9"
    REACHED = "reached: the law meets the target within 1 %"
    WITHIN_ERRORS = "reached: the law meets the samples within 1 % and their stated errors"
    REFINED = "refined: the heights were adjusted until the law met the target within 1 %"
    APPROXIMATE = "approximate: the heights follow a density whose law has the target's slopes at large loads"
    MISSED = (
        "missed: the misfit is above 1 % (and the errors of the samples), or above 10 % for the heights of a "
        "density, or the base plane would touch"
    )


def misfit_text(misfit: float, digits: int = 2) -> str:
    """Return a misfit in percent, or a statement that it is within the tolerance of exact designs.

    The text has enough digits to show on which side of a limit the misfit lies: 1.003 % is not "1 %".
    """
    if misfit <= EXACT:
        return "below 1e-9"
    enough = (n for n in range(digits, MOST_DIGITS) if _above(float(f"{misfit:.{n}g}")) == _above(misfit))
    return percent(misfit, f".{next(enough, digits)}g")


def _above(misfit: float) -> list[bool]:
    """Return whether a misfit exceeds `REACHED`, and whether it exceeds `MISSED`."""
    return [misfit > limit for limit in (REACHED, MISSED)]
