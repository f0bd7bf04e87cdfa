"""The law of an answer as data for the plot, in newtons or rescaled, and measured points beside it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any
from zlib import crc32

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.certainty import Band
from metafem.explorer.handles import scene_of
from metafem.explorer.kinds import offer
from metafem.explorer.scene import Handle
from metafem.files.laws import columns_of, read_measured_law
from metafem.files.tables import table_of
from metafem.inversion import OperatingPoints
from metafem.surface import Friction, Material, Surface

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


# Number of tables whose points are stored: those of the open pages, which are few.
TABLES = 4

# Column that only the table of a target law has; a table of a measured law does not have it.
RESCALED = "rescaled_load"


@dataclass(frozen=True, eq=False)
class Points:
    """Points of a measured law: rescaled loads and frictions [mm^2], arrays (k,)."""

    name: str
    load: FloatArray
    friction: FloatArray

    def data(self, units: Units) -> dict[str, Any]:
        """Return the points in the units of the axes."""
        words = f"{self.name}: {len(self.load):,} points"
        return {"name": words, **units.curve(self.load, self.friction)}


def read_points(name: str, text: str, material: Material, friction: Friction | None) -> Points:
    """Return the points in a table of a measured law or of a target law.

    Raises
    ------
    InvalidInput
        If the text is no such table; the message names the table.
    """
    if "\0" in text:
        raise InvalidInput(f"{name} is not a table: it holds null characters")
    header = next((line for line in text.splitlines() if line.strip() and not line.startswith("#")), "")
    content = text.encode("utf-8", "surrogatepass")
    if RESCALED in header.lower().replace(" ", "_"):
        columns = columns_of(table_of(name, content), "sampled")
        return Points(name, columns[RESCALED], columns["rescaled_friction"])
    law = read_measured_law(table_of(name, content), material, friction)
    known = np.isfinite(law.rescaled_friction)
    return Points(name, law.rescaled_load[known], law.rescaled_friction[known])


# the points of the last few tables, which every answer shows
_read = lru_cache(TABLES)(read_points)


def measured_of(answer: Answer) -> Points | None:
    """Return the measured points of an answer; None without a table or a specification.

    Raises
    ------
    InvalidInput
        If the table cannot be read.
    """
    state, template = answer.state, answer.template
    if not state.measured or template is None:
        return None
    return _read(state.measured_name, state.measured, template.material, template.friction)


# Text after the refusal of a draft if no bound proves the refusal.
SEARCHED = "A longer search follows."


def law_data(answer: Answer) -> dict[str, Any]:
    """Return the curves and handles of an answer in the units of the axes, and its target as ``base``."""
    units = Units.of(answer.template, answer.state.newtons)
    own = Units.of_design(answer, answer.state.newtons)
    given = answer.specification
    scene = None if given is None else scene_of(answer.state, given, answer.design)
    target, many = (scene.target, scene.crowd) if scene else (None, 0)
    marked = isinstance(target, OperatingPoints) and not many
    law = None if answer.design is None else answer.design.law
    return {
        "number": answer.number,
        "base": scene,  # every step of a drag starts there
        # checksum of the text: messages below the plot are valid for this text only
        "state": crc32(answer.state.text.encode()),
        **units.axes(),
        "achieved": None if law is None else own.curve(law.rescaled_load, law.rescaled_friction),
        "model": "" if law is None else law.model.name + ", draft" * answer.simplified,
        "wanted": None if scene is None else units.curve(*scene.curve()),
        "marked": marked,
        "crowd": f"{many:,} points, too many to drag" if many else "",
        "nearest": None if answer.nearest is None else units.curve(*answer.nearest) | {"marked": marked},
        # label of the button that adopts the nearest law
        "offer": "" if answer.nearest is None else offer(answer),
        "refusal": f"{answer.refused.removesuffix('.')}. {SEARCHED}" if answer.undecided else answer.refused,
        "undecided": answer.undecided,
        # None if the text has problems, because its handles are then unknown
        "handles": None if scene is None else [_handle(each, units) for each in scene.handles()],
        "load_scale": own.load,  # units of the load axis per rescaled load
        "cursor": None if answer.state.load is None else numbers([own.load * answer.state.load], EDITED)[0],
    }


def pinned_data(pinned: Answer | None, units: Units) -> dict[str, Any] | None:
    """Return the law of a pinned answer in the units of the axes; None if it has no forces for newtons."""
    if pinned is None or pinned.design is None:
        return None
    own, law = Units.of_design(pinned, units.newtons), pinned.design.law
    return own.curve(law.rescaled_load, law.rescaled_friction) if own.newtons == units.newtons else None


def band_data(band: Band, units: Units, **more: Any) -> dict[str, Any]:
    """Return loads, lowest and highest friction of a band of laws, in the units of the axes."""
    load, low, high = band
    x, y = numbers(units.load * load), units.friction
    return {"x": x, "low": numbers(y * low), "high": numbers(y * high), **more}


def _handle(handle: Handle, units: Units) -> dict[str, Any]:
    """Return a handle at its place in the units of the axes."""
    x, y = numbers([units.load * handle.load, units.friction * handle.friction], EDITED)
    return {**vars(handle), "x": x, "y": y}
