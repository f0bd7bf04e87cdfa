"""The tolerance band: the scatter of the laws of manufactured surfaces about the law of the design.

Linear response gives the band at once, from the derivatives dA0/dh and the covariance of the height errors.
Random draws of manufactured surfaces take longer. They also include second-order effects, which matter where
contacts open, and the errors of radii and positions.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from weakref import finalize

import numpy as np

from metafem._validate import FloatArray
from metafem._values import MICROMETRES, percent
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.inversion import Design
from metafem.inversion.targets.wording import listed
from metafem.prediction import Tolerances
from metafem.progress import doing
from metafem.surface import Surface

# A band, or a further law beside it, is computed at every n-th load of the law: at 34 of 100 loads. Straight
# lines are drawn between them.
EVERY = 3

# Largest numbers of independent and of coupled asperities for a band by linear response. Coupled asperities
# require the solution of n equations at each load, which takes 13 ms for 64 asperities and about a second for
# the largest number.
MOST_ALONE, MOST_COUPLED = 100_000, 400

# Number of draws, smallest number of draws with a solution, and random seed.
DRAWS, FEWEST, SEED = 200, 100, 0

# Number of draws solved first to measure their duration; time between two checks whether the draws are still
# needed [s], which can delay a newer law by this time; and longest time of all draws [s].
FIRST, PART, LONGEST = 2, 0.05, 20.0

# Rescaled load, and lowest and highest friction [mm^2].
Band = tuple[FloatArray, FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Scatter:
    """Mean and standard deviation of A0 of made surfaces at each rescaled load [mm^2], arrays (k,).

    `count` is the number of drawn surfaces; it is 0 for linear response.
    """

    load: FloatArray
    mean: FloatArray
    sd: FloatArray
    count: int = 0


# Linear responses and finished draws of the designs on open pages, by the identity of the design, because
# hashing a design would compute all of its notes. Each is stored as long as its design exists.
_LINEAR: dict[int, Scatter | None] = {}
_DRAWN: dict[int, Scatter] = {}


def tolerances_of(answer: Answer) -> Tolerances | None:
    """Return the manufacturing errors that a specification states; None if it states none.

    These are the errors in ``[robust]`` or, without this section, ``limits.height_sd``.
    """
    design = answer.design
    if design is None:
        return None
    if design.robust is not None and design.robust.dimensions(design.surface):
        return design.robust
    deviation = design.limits.height_sd
    return Tolerances(height_sd=deviation) if deviation else None


def tolerance_words(tolerances: Tolerances) -> str:
    """Return the manufacturing errors of the part in words.

    Examples
    --------
    >>> tolerance_words(Tolerances(height_sd=0.0009, angle=0.001))
    'errors of the heights of 0.9 µm (SD) and tilts within ±0.057°'
    """
    sds = {
        "heights": tolerances.height_sd,
        "radii": tolerances.radius_sd,
        "sites": tolerances.position_sd,
    }
    parts = [f"errors of the {name} of {MICROMETRES * sd:.3g} µm (SD)" for name, sd in sds.items() if sd]
    if tolerances.angle:
        parts.append(f"tilts within ±{np.degrees(tolerances.angle):.2g}°")
    return listed(parts)


def tolerance_band(answer: Answer) -> Band | None:
    """Return rescaled load, and A0 of manufactured surfaces one standard deviation below and above [mm^2].

    The band comes from draws if `draw` has finished for this answer, otherwise from linear response. The
    result is None without draws if the specification states no errors, the surface has too many asperities or
    the model has no solution.
    """
    found = drawn_of(answer) or linear(answer)
    return None if found is None else (found.load, found.mean - found.sd, found.mean + found.sd)


def band_words(answer: Answer) -> str:
    """Return the description of the band of an answer; "" if the specification states no errors."""
    tolerances = tolerances_of(answer)
    if tolerances is None:
        return ""
    drawn = drawn_of(answer)
    if drawn is None:
        return f"± 1 SD of made surfaces, linear response to {tolerance_words(tolerances)}"
    made = f"{drawn.count} made surfaces, drawn with {tolerance_words(tolerances)}"
    first, apart = linear(answer), ""
    if first is not None and first.sd.any():
        rms = float(np.sqrt(((first.sd - drawn.sd) ** 2).sum() / (drawn.sd**2).sum()))
        apart = f"; linear response differs by {percent(rms)} of it"
    return f"± 1 SD about the mean of {made}{apart}"


def drawn_of(answer: Answer) -> Scatter | None:
    """Return the finished draws for the design of an answer, or None."""
    return _DRAWN.get(id(answer.design))


def linear(answer: Answer) -> Scatter | None:
    """Return the scatter by linear response; None if it is not available."""
    design, tolerances = answer.design, tolerances_of(answer)
    if design is None or tolerances is None:
        return None
    if id(design) not in _LINEAR:
        finalize(design, _LINEAR.pop, id(design), None)
        _LINEAR[id(design)] = _linear(design, tolerances)
    return _LINEAR[id(design)]


def _linear(design: Design, tolerances: Tolerances) -> Scatter | None:
    model, surface = design.law.model.gradient_model, design.surface
    if surface.count > (MOST_COUPLED if model.couples else MOST_ALONE):
        return None
    load = loads_of(design)
    try:
        found = model.sensitivity(surface, load)
        mean = found.curve.checked().area
        return Scatter(load, mean, deviations(tolerances, surface, found.gradient))
    except MetafemError:  # the model has no solution at these loads
        return None


def deviations(tolerances: Tolerances, surface: Surface, gradient: FloatArray) -> FloatArray:
    """Return the standard deviations of linear functions of the heights, (k,)."""
    variance = np.diagonal(tolerances.linear_covariance(surface, gradient))
    return np.asarray(np.sqrt(np.maximum(variance, 0.0)))  # rounding can make a variance negative


def loads_of(design: Design) -> FloatArray:
    """Return the rescaled loads of a band [mm^2]: every n-th load of the law, including the last load."""
    return np.asarray(design.law.rescaled_load[::-EVERY][::-1])


def draw(answer: Answer) -> Scatter | None:
    """Draw random surfaces within the tolerances; store and return the mean and scatter of their laws.

    Returns None, and stores nothing, if the draws would take too long, no errors are stated, or too few
    surfaces have a solution.
    """
    design, tolerances = answer.design, tolerances_of(answer)
    if design is None or tolerances is None:
        return None
    model, load, start = design.law.model.gradient_model, loads_of(design), time.monotonic()
    unit = np.random.default_rng(SEED).random((DRAWS, tolerances.dimensions(design.surface)))
    parts: list[FloatArray] = []
    done, size = 0, FIRST
    while done < DRAWS:
        try:
            with doing("drawing surfaces"):  # a step, at which draws that are not needed end
                drawn = tolerances.perturbed(design.surface, unit[done : done + size])
                parts.append(np.asarray(model.areas(design.surface, load, *drawn)))  # nan without a solution
        except MetafemError:  # the model is not valid for a drawn surface
            return None
        done += size
        each = (time.monotonic() - start) / done
        if each * DRAWS > LONGEST:
            return None
        size = max(1, int(PART / max(each, PART / DRAWS)))
    area = np.concatenate(parts)
    area = area[np.isfinite(area).all(axis=1)]
    if len(area) < FEWEST:
        return None
    finalize(design, _DRAWN.pop, id(design), None)
    _DRAWN[id(design)] = Scatter(load, area.mean(axis=0), area.std(axis=0, ddof=1), len(area))
    return drawn_of(answer)
