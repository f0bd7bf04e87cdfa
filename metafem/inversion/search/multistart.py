"""Descents from several initial guesses and from random changes of the best result.

A0(P) has kinks in the heights where asperities enter the contact, so a descent can end at a local minimum.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from metafem._validate import FloatArray
from metafem.inversion.search.levenberg_marquardt import Minimum, Residual, Space, descend
from metafem.inversion.search.options import DEFAULTS, SearchOptions
from metafem.progress import each


def search(
    residual: Residual,
    starts: Sequence[FloatArray],
    space: Space,
    goal: float,
    restarts: int,
    rng: np.random.Generator,
    options: SearchOptions = DEFAULTS,
) -> Minimum:
    """Descend from every initial guess, then from random changes of the best result."""
    best = Minimum(starts[0], np.inf)
    for start in each("start", starts, at_most=True):
        found = descend(residual, space.project(start), space, goal, options=options)
        best = found if found.misfit < best.misfit else best
        if best.misfit <= options.near * goal:
            break
    for _ in each("random change", range(restarts), at_most=True):
        if best.misfit <= goal:
            break
        change = space.project(space.changed(best.unknowns, rng, options))
        found = descend(residual, change, space, goal, options=options)
        best = found if found.misfit < best.misfit else best
    return best
