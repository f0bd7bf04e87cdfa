"""The largest slope, or friction coefficient, of a line without a range of loads."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from metafem.errors import Infeasible
from metafem.files import Specification
from metafem.inversion import Design, DesignStatus, LinearLaw
from metafem.models import Model

# Number of times that a slope is halved until it is met, down to 1/4096 of it, and of bisections after that:
# 2^(1/128) is 1.005, about the three digits that the slope has.
HALVINGS, BISECTIONS = 12, 7


def largest_line(specification: Specification, model: Model) -> tuple[LinearLaw, str] | None:
    """Return the steepest line that quick searches meet, and the loads over which they meet it in words.

    None is returned for a target other than one line without a load range, and if no slope is met.
    """
    target: Any = specification.target
    if len(target.lines) != 1 or target.load_range is not None:
        return None
    wording = target.wording

    def met(value: float) -> Design | None:
        slope = wording.slope(float(f"{value:.3g}"))
        try:
            found = replace(specification, target=replace(target, slope=slope)).design(model, draft=True)
        except Infeasible:
            return None
        return None if found.status is DesignStatus.MISSED else found

    given = wording.coefficient(target.slope)
    halved = ((value, met(value)) for value in (given / 2.0**k for k in range(1, HALVINGS + 1)))
    low, best = next((each for each in halved if each[1] is not None), (0.0, None))
    high = 2.0 * low
    for _ in range(BISECTIONS):
        middle = (low * high) ** 0.5
        found = None if best is None else met(middle)
        low, high, best = (low, middle, best) if found is None else (middle, high, found)
    if best is None:
        return None
    line: Any = best.target
    return line, wording.inside(*best.fits[0][0].load_range)
