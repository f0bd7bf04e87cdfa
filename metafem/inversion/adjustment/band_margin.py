"""Heights whose law has the largest margin to both curves of a band.

The margin of a law A (k,) in the band from l to u is

    t = min_k min(A_k - l_k, u_k - A_k)/w_k,        w = (u - l)/2.

With the exact sensitivities ``G = dA0/dh`` a step s of the heights is the solution of the linear program

    max t   subject to   A + G s - l >= t w,   u - A - G s >= t w,   |s_i| <= D,   foot <= h + s <= top.

The step is taken if the margin of the model increases; otherwise the bound D is a quarter of the former.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import linprog

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.inversion.candidate import Candidate
from metafem.models import Model
from metafem.progress import doing, each
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.inversion.problem import Problem

# Margin at which the search ends; 1 is the middle of the band.
ENOUGH = 0.99

# Maximum number of steps; the first and the smallest bound of a step relative to the mean radius.
STEPS, FIRST, LEAST = 60, 1e-2, 1e-7

# The search ends if this number of steps together increase the margin by less than this.
PATIENCE, GAIN = 5, 1e-3


def margin(area: FloatArray, ends: tuple[FloatArray, FloatArray]) -> float:
    """Return the margin [-] of a law (k,) [mm^2] to the curves of a band: 1 in the middle, 0 on a curve."""
    low, high = ends
    return float((np.minimum(area - low, high - area) / (0.5 * (high - low))).min())


def area_of(model: Model, surface: Surface, height: FloatArray, load: FloatArray) -> FloatArray | None:
    """Return A0 (k,) [mm^2] of heights (n,) [mm] under a model; None beyond the range of its contact law."""
    try:
        return model.curve(surface.replaced(height=height), load).checked().area
    except InvalidInput:
        return None


@doing("widening the margin to the band")
def widest(problem: Problem, candidate: Candidate) -> tuple[Candidate, FloatArray]:
    """Return the candidate with the largest margin found, and its A0 (k,) [mm^2] under the model."""
    law, limits, model = candidate.target_law, problem.limits, problem.model
    surface, height = candidate.surface(problem.template), candidate.height
    assert law.ends is not None
    (low, high), load = law.ends, law.load
    half = 0.5 * (high - low)
    area = model.curve(surface, load).checked().area
    found, moved, size = margin(area, law.ends), False, FIRST * float(surface.radius.mean())
    least, history = LEAST * size / FIRST, [found]
    gradient: FloatArray | None = None
    for _ in each("step", range(STEPS), at_most=True):
        stalled = len(history) > PATIENCE and history[-1] - history[-1 - PATIENCE] < GAIN
        if found >= ENOUGH or size < least or candidate.stepped or (stalled and found > 0.0):
            break
        if gradient is None:
            gradient = model.gradient_model.sensitivity(surface, load, height).gradient
        step = _step(area, gradient, (low, high, half), size, (limits.foot - height, limits.top - height))
        if step is None:
            break
        trial = np.clip(height + step, limits.foot, limits.top)
        new = area_of(model, surface, trial, load)
        if new is not None and (better := margin(new, law.ends)) > found:
            height, area, found, moved, gradient = trial, new, better, True, None
            size *= 2.0
            history.append(found)
        else:
            size *= 0.25
    if moved:
        candidate = candidate.with_heights(height)
    parameters = {**candidate.parameters, "band_margin": found}
    return replace(candidate, parameters=parameters), area


def _step(
    area: FloatArray,
    gradient: FloatArray,
    band: tuple[FloatArray, FloatArray, FloatArray],
    size: float,
    room: tuple[FloatArray, FloatArray],
) -> FloatArray | None:
    """Return the step (n,) [mm] of the linear program, in units of `size` within; None if it has none."""
    low, high, half = band
    scaled = size * gradient / half[:, None]
    one = np.ones((len(area), 1))
    rows = np.vstack([np.hstack([-scaled, one]), np.hstack([scaled, one])])
    right = np.concatenate([(area - low) / half, (high - area) / half])
    count = gradient.shape[1]
    lower, upper = (np.clip(part / size, -1.0, 1.0) for part in room)
    ends = [*zip(np.minimum(lower, 0.0), np.maximum(upper, 0.0), strict=True), (None, 1.0)]
    found = linprog(np.append(np.zeros(count), -1.0), rows, right, bounds=ends, method="highs")
    return size * np.asarray(found.x[:count]) if found.success else None
