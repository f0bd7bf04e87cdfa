"""Units of the plotted law, rescaled or newtons, and rounding of the plotted numbers."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.explorer.answer import Answer
from metafem.surface import Surface

# Largest number of points of a plotted curve. Neighbouring points are then a few pixels apart.
MOST_POINTS = 200

# Significant digits of plotted curves (finer than a tenth of a pixel) and of values that are edited.
DRAWN, EDITED = 5, 9

# The axes: name, label in newtons, and label and explanation of the rescaled values.
AXES = {
    "x": ("load", "load P", "load P/E*", "Load P divided by the composite modulus E*: an area"),
    "y": (
        "friction", "friction force F", "friction F/(σB)",
        "Friction force F divided by the shear strength σ and the area ratio B: an area",
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Units:
    """Factors from rescaled load and friction [mm^2] to the units of the axes, and the labels of the axes."""

    load: float = 1.0
    friction: float = 1.0
    newtons: bool = False

    @classmethod
    def of(cls, template: Surface | None, newtons: bool) -> Units:
        """Return units in newtons if `newtons` and the surface has a friction, otherwise rescaled units."""
        if template is None or template.friction is None or not newtons:
            return cls()
        return cls(template.material.composite_modulus, template.friction.stress, True)

    @classmethod
    def of_design(cls, answer: Answer, newtons: bool) -> Units:
        """Return the units for the design in an answer, whose material may be that of an earlier state."""
        axes = cls.of(answer.template, newtons)
        own = axes if answer.design is None else cls.of(answer.design.template, newtons)
        return own if own.newtons == axes.newtons else axes

    def axes(self) -> dict[str, dict[str, str]]:
        """Return names, labels, units and explanations of both axes."""
        return {
            axis: {"name": name, "label": forces, "unit": "N", "meaning": ""}
            if self.newtons
            else {"name": name, "label": label, "unit": "mm²", "meaning": meaning}
            for axis, (name, forces, label, meaning) in AXES.items()
        }

    def curve(self, load: FloatArray, friction: FloatArray) -> dict[str, Any]:
        """Return a curve in the units of the axes, reduced to at most `MOST_POINTS` points."""
        count = len(load)  # if there are more points, evenly spaced ones are drawn, including both ends
        rows = np.linspace(0, count - 1, min(count, MOST_POINTS)).round().astype(np.int64)
        return {"x": numbers(self.load * load[rows]), "y": numbers(self.friction * friction[rows])}

    def rescaled(self, x: float, y: float) -> tuple[float, float]:
        """Return the rescaled load and friction [mm^2] of a point in the units of the axes."""
        return x / self.load, y / self.friction


def numbers(values: FloatArray | Iterable[float], digits: int = DRAWN) -> list[float | None]:
    """Return numbers rounded to significant digits, None for numbers that are not finite."""
    return [float(f"{value:.{digits}g}") if np.isfinite(value) else None for value in values]
