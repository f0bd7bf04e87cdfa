"""The units in which a law is shown, rescaled or in newtons, and numbers with few digits."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.explorer.answer import Answer
from metafem.surface import Surface

# Points of a curve on the screen: neighbouring ones are a few pixels apart.
MOST_POINTS = 200

# Significant digits of a curve, below a tenth of a pixel, and of values that are edited.
DRAWN, EDITED = 5, 9

# What rescaled values are.
RESCALED = {
    "x": "Load P divided by the composite modulus E*: an area",
    "y": "Friction force F divided by the shear strength σ and the area ratio B: an area",
}


@dataclass(frozen=True)
class Units:
    """Factors from rescaled load and friction [mm^2] to what is shown, and the labels of the axes."""

    load: float = 1.0
    friction: float = 1.0
    newtons: bool = False

    @classmethod
    def of(cls, answer: Answer, newtons: bool) -> Units:
        """Return newtons if they are wanted and the surface has a friction, else rescaled units.

        Where the text of an answer has problems they are those of the last design.
        """
        known = answer.design if answer.specification is None else answer.specification
        return cls._of_template(None if known is None else known.template, newtons)

    @classmethod
    def of_design(cls, answer: Answer, newtons: bool) -> Units:
        """Return the units of the design that an answer shows, which may be that of an earlier material."""
        axes = cls.of(answer, newtons)
        own = axes if answer.design is None else cls._of_template(answer.design.template, newtons)
        return own if own.newtons == axes.newtons else axes

    @classmethod
    def _of_template(cls, template: Surface | None, newtons: bool) -> Units:
        """Return the units of a surface."""
        if template is None or template.friction is None or not newtons:
            return cls()
        stress = template.friction.shear_strength * template.friction.area_ratio
        return cls(template.material.composite_modulus, stress, True)

    def axes(self) -> dict[str, dict[str, str]]:
        """Return names, labels and units of both axes."""
        unit = "N" if self.newtons else "mm²"
        labels = ("load P", "friction force F") if self.newtons else ("load P/E*", "friction F/(σB)")
        names = {"x": ("load", labels[0]), "y": ("friction", labels[1])}
        return {
            axis: {
                "name": name,
                "label": label,
                "unit": unit,
                "meaning": "" if self.newtons else RESCALED[axis],
            }
            for axis, (name, label) in names.items()
        }

    def curve(self, load: FloatArray, friction: FloatArray) -> dict[str, Any]:
        """Return a curve, thinned and in the units that are shown."""
        rows = rows_shown(len(load))
        return {"x": numbers(self.load * load[rows]), "y": numbers(self.friction * friction[rows])}

    def rescaled(self, x: float, y: float) -> tuple[float, float]:
        """Return the rescaled load and friction of a point that is shown [mm^2]."""
        return x / self.load, y / self.friction


def rows_shown(count: int) -> Any:
    """Return the rows of a curve that are drawn: all, or evenly spaced ones with both ends."""
    if count <= MOST_POINTS:
        return slice(None)
    return np.unique(np.linspace(0, count - 1, MOST_POINTS).round().astype(np.int64))


def numbers(values: FloatArray | Iterable[float], digits: int = DRAWN) -> list[float | None]:
    """Return numbers with some digits, None for those that are not finite."""
    return [float(f"{value:.{digits}g}") if np.isfinite(value) else None for value in values]
