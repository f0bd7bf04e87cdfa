"""The tolerance band: how far the laws of made surfaces scatter around that of the design.

Linear response gives it at once: with the derivatives dA0/dh and the covariance of the errors of the heights.
Draws of made surfaces also have the second-order effects, which count where contacts open, and the errors of
the radii and the sites; they take longer.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, TypeVar
from weakref import finalize

import numpy as np

from metafem._validate import FloatArray
from metafem._values import MICROMETRES, percent
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer
from metafem.inversion import Design
from metafem.models import Model
from metafem.prediction import Tolerances
from metafem.surface import Surface

# Every n-th load of a law is enough for a band: 34 of 100.
EVERY = 3

# Largest number of asperities whose band is computed at once. Coupled ones need the solution of n equations
# at each load: 13 ms for 64 of them, and about a second for this number.
MOST_ALONE, MOST_COUPLED = 100_000, 400

# Draws, the fewest with a solution, and the seed of all.
DRAWS, FEWEST, SEED = 200, 100, 0

# Draws that are solved first, to see how long they take; seconds between two questions whether they are still
# wanted, in which a newer law waits for them; and the longest time of all draws.
FIRST, PART, LONGEST = 2, 0.05, 20.0

Band = tuple[FloatArray, FloatArray, FloatArray]

# Rescaled load, A0 and its standard deviation [mm^2].
Linear = tuple[FloatArray, FloatArray, FloatArray]


@dataclass(frozen=True, eq=False)
class Drawn:
    """Moments of the laws of drawn surfaces over the rescaled load [mm^2]."""

    load: FloatArray
    mean: FloatArray  # of A0 [mm^2]
    sd: FloatArray
    linear: FloatArray  # the standard deviation by linear response
    count: int

    @property
    def difference(self) -> float:
        """Root mean square of the difference of linear response from the draws, over that of the draws."""
        return float(np.sqrt(((self.linear - self.sd) ** 2).sum() / (self.sd**2).sum()))


Value = TypeVar("Value")


class Known(Generic[Value]):
    """What is known of designs, as long as they live; to hash a design would compute all of its notes."""

    def __init__(self) -> None:
        self._values: dict[int, Value] = {}

    def __contains__(self, design: Design) -> bool:
        return id(design) in self._values

    def get(self, design: Design | None) -> Value | None:
        """Return what is known of a design, or None."""
        return self._values.get(id(design))

    def keep(self, design: Design, value: Value) -> Value:
        """Keep and return a value of a design."""
        if design not in self:
            finalize(design, self._values.pop, id(design), None)
        self._values[id(design)] = value
        return value


# What is known of the designs that are shown.
_LINEAR: Known[Linear | None] = Known()
_DRAWN: Known[Drawn] = Known()


def tolerances_of(answer: Answer) -> Tolerances | None:
    """Return the errors of the part in a specification: ``[robust]``, or else ``limits.height_sd``."""
    design = answer.design
    if design is None:
        return None
    if design.robust is not None and design.robust.dimensions(design.surface):
        return design.robust
    deviation = design.limits.height_sd
    return Tolerances(height_sd=deviation) if deviation else None


def tolerance_words(tolerances: Tolerances) -> str:
    """Return the errors of the part in words.

    Examples
    --------
    >>> tolerance_words(Tolerances(height_sd=0.0009, angle=0.001))
    'errors of the heights of 0.9 µm (SD) and tilts within ±0.057°'
    """
    parts = [
        f"{words} of {MICROMETRES * value:.3g} µm (SD)"
        for words, value in (
            ("errors of the heights", tolerances.height_sd),
            ("errors of the radii", tolerances.radius_sd),
            ("errors of the sites", tolerances.position_sd),
        )
        if value
    ]
    if tolerances.angle:
        parts.append(f"tilts within ±{np.degrees(tolerances.angle):.2g}°")
    return ", ".join(parts[:-1]) + " and " * (len(parts) > 1) + parts[-1]


def tolerance_band(answer: Answer) -> Band | None:
    """Return rescaled load, and A0 of made surfaces one standard deviation below and above [mm^2].

    By draws where `draw` has finished for this answer, by linear response otherwise. None where the part has
    no stated errors, or too many asperities to have a band at once.
    """
    drawn = drawn_of(answer)
    if drawn is not None:
        return drawn.load, drawn.mean - drawn.sd, drawn.mean + drawn.sd
    found = linear(answer)
    if found is None:
        return None
    load, area, sd = found
    return load, area - sd, area + sd


def band_words(answer: Answer) -> str:
    """Return what the band of an answer is: "" without one."""
    tolerances = tolerances_of(answer)
    if tolerances is None:
        return ""
    drawn = drawn_of(answer)
    if drawn is None:
        return f"± 1 SD of made surfaces, linear response to {tolerance_words(tolerances)}"
    apart = f"; linear response differs by {percent(drawn.difference)} of it" if drawn.linear.any() else ""
    made = f"{drawn.count} made surfaces, drawn with {tolerance_words(tolerances)}"
    return f"± 1 SD about the mean of {made}{apart}"


def drawn_of(answer: Answer) -> Drawn | None:
    """Return the finished draws of an answer."""
    return _DRAWN.get(answer.design)


def linear(answer: Answer) -> Linear | None:
    """Return rescaled load, A0 and its standard deviation by linear response [mm^2]; None as for the band."""
    design, tolerances = answer.design, tolerances_of(answer)
    if design is None or tolerances is None:
        return None
    return _LINEAR.get(design) if design in _LINEAR else _LINEAR.keep(design, _linear(design, tolerances))


def _linear(design: Design, tolerances: Tolerances) -> Linear | None:
    model, surface = design.law.model.gradient_model, design.surface
    if surface.count > (MOST_COUPLED if model.couples else MOST_ALONE):
        return None
    load = loads_of(design)
    try:
        found = model.sensitivity(surface, load)
        return load, found.curve.checked().area, deviations(tolerances, surface, found.gradient)
    except MetafemError:  # the model has no solution at these loads
        return None


def deviations(tolerances: Tolerances, surface: Surface, gradient: FloatArray) -> FloatArray:
    """Return the standard deviations of linear functions of the heights, (k,)."""
    variance = np.diagonal(tolerances.linear_covariance(surface, gradient))
    return np.asarray(np.sqrt(np.maximum(variance, 0.0)))  # rounding


def loads_of(design: Design) -> FloatArray:
    """Return the rescaled loads of a band, the last of the law among them [mm^2]."""
    return np.asarray(design.law.rescaled_load[::-EVERY][::-1])


def draw(answer: Answer, wanted: Callable[[], bool]) -> Drawn | None:
    """Draw made surfaces of an answer, and keep their moments as its band.

    None, and nothing is kept, where they are no longer wanted or would take long, the part has no stated
    errors, or too few surfaces have a solution.
    """
    design, tolerances = answer.design, tolerances_of(answer)
    if design is None or tolerances is None:
        return None
    model, load, start = design.law.model.gradient_model, loads_of(design), time.monotonic()
    unit = np.random.default_rng(SEED).random((DRAWS, tolerances.dimensions(design.surface)))
    parts: list[FloatArray] = []
    done, size = 0, FIRST
    while done < DRAWS:
        if not wanted():
            return None
        try:
            parts.append(_areas(model, design.surface, load, tolerances, unit[done : done + size]))
        except MetafemError:  # the model does not hold for a drawn surface
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
    first = linear(answer)
    sd = np.zeros(len(load)) if first is None else first[2]
    return _DRAWN.keep(design, Drawn(load, area.mean(axis=0), area.std(axis=0, ddof=1), sd, len(area)))


def _areas(
    model: Model, surface: Surface, load: FloatArray, tolerances: Tolerances, unit: FloatArray
) -> FloatArray:
    """Return A0 (m, k) of drawn surfaces [mm^2], nan where there is no solution."""
    heights, radii, positions = tolerances.perturbed(surface, unit)
    return np.asarray(model.areas(surface, load, heights, radii, positions))
