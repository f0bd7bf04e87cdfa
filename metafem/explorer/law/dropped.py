"""Measured points from a table file that the user drops onto the plot of the law."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.law.shown import Units
from metafem.files.laws import columns_of, read_measured_law
from metafem.files.tables import table_of
from metafem.surface import Friction, Material

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
