"""Measured points from a table file that the user drops onto the plot of the law."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import lru_cache
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.calibration import MeasuredLaw
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.law.shown import EDITED, Units, numbers
from metafem.explorer.text.document import Document
from metafem.files.measurement.laws import COLUMNS, read_measured_law
from metafem.files.samples import TARGET, columns_of
from metafem.files.tables import ALIASES, table_of
from metafem.inversion import Design
from metafem.progress import listening
from metafem.surface import Friction, Material

# Largest number of points of a table. More points could not be distinguished on a plot.
MOST = 2000

# Number of tables whose points are stored: those of the open pages, which are few.
TABLES = 4

# Column that only the table of a target law has; a table of a measured law does not have it.
RESCALED = "rescaled_load"

# Column names that people often use, each with the matching column title and its unit.
KNOWN = {name: TARGET.title(name) for name in TARGET.units}
KNOWN |= {name: TARGET.title(known) for name, known in ALIASES.items()}

# Title of a column: a name, and optionally a unit after it, with or without brackets.
TITLE = re.compile(r"\s*(.*?)(?:[\s_]*[\[(]\s*(\S+?)\s*[\])]|[\s_]+([mkuµ]?N|[mcuµ]?m(?:\^?2|²)))?\s*")

# Similarity of two names, as `difflib` computes it, from which one name is suggested for the other.
LIKE = 0.6


@dataclass(frozen=True, eq=False)
class Points:
    """Points of a measured law: rescaled loads, frictions and standard deviations [mm^2], arrays (k,)."""

    name: str
    load: FloatArray
    friction: FloatArray
    load_sd: FloatArray | None = None
    friction_sd: FloatArray | None = None
    remarks: tuple[str, ...] = ()

    def difference(self, design: Design) -> tuple[float, int]:
        """Return the rms relative difference between a design's law and the points, and the number compared.

        Only points with a positive friction and a load within the range of the law are compared.
        """
        law = design.law
        rows = (self.load >= law.rescaled_load[0]) & (self.load <= law.rescaled_load[-1])
        rows &= self.friction > 0.0
        if not rows.any():
            return 0.0, 0
        achieved = np.interp(self.load[rows], law.rescaled_load, law.rescaled_friction)
        return float(np.sqrt(((achieved / self.friction[rows] - 1.0) ** 2).mean())), int(rows.sum())

    def words(self, design: Design | None) -> str:
        """Return the label of the points: their name, and how far a design's law differs from them."""
        count = len(self.load)
        if design is None:
            return f"{self.name}: {count} points"
        difference, near = self.difference(design)
        if not near:
            return f"{self.name}: {count} points, none at the loads of the achieved law"
        at = f"{count} points" if near == count else f"{near} of {count} points"
        return f"{self.name}: the achieved law differs by {percent(difference)} (rms at {at})"

    def data(self, units: Units, design: Design | None) -> dict[str, Any]:
        """Return the points in the units of the axes."""
        x_sd, y_sd = self.load_sd, self.friction_sd
        return {
            "name": self.words(design),
            "x": numbers(units.load * self.load),
            "y": numbers(units.friction * self.friction),
            "x_sd": None if x_sd is None else numbers(units.load * x_sd),
            "y_sd": None if y_sd is None else numbers(units.friction * y_sd),
        }


def read_points(name: str, text: str, material: Material, friction: Friction | None) -> Points:
    """Return the points in a table of a measured law or of a target law.

    Raises
    ------
    InvalidInput
        If the text is no such table or has too many points; the message names the table.
    """
    remarks: list[str] = []
    if "\0" in text:
        raise InvalidInput(f"{name} is not a table: it holds null characters")
    header = next((line for line in text.splitlines() if line.strip() and not line.startswith("#")), "")
    content = text.encode("utf-8", "surrogatepass")
    with listening(lambda step, done: None, remarks.append):
        if RESCALED in header.lower().replace(" ", "_"):
            columns = columns_of(name, content, TARGET)
            found = Points(name, columns[RESCALED], columns["rescaled_friction"])
        else:
            try:
                law = read_measured_law(table_of(name, content, COLUMNS.example), material, friction)
            except InvalidInput as error:
                raise InvalidInput(f"{error}.{_offer(header)}") from None
            found = _measured(name, law, header.lower().replace(" ", "_"))
    if len(found.load) > MOST:
        raise InvalidInput(f"{name} has {len(found.load):,} points; at most {MOST:,} are shown")
    return replace(found, remarks=tuple(remarks))


def as_target(answer: Answer) -> str:
    """Return the text of an answer with its points as a sampled target law, to be met by least squares.

    Points with equal loads are replaced by one point with their mean friction. Points are omitted if their
    load or friction is not positive.
    """
    found = measured_of(answer)
    if found is None:
        raise InvalidInput("there are no measured points that could be the target")
    rows = (found.load > 0.0) & (found.friction > 0.0)
    load = np.unique(found.load[rows])
    if not load.size:
        raise InvalidInput(f"{found.name} has no point with a load and a friction above 0")
    friction = np.array([found.friction[rows][found.load[rows] == each].mean() for each in load])
    units = Units.of(answer.template, answer.state.newtons)
    keys = ("load", "friction_force") if units.newtons else ("rescaled_load", "rescaled_friction")
    values = {
        key: [f"{value:.{EDITED}g} {'N' if units.newtons else 'mm^2'}" for value in each]
        for key, each in zip(keys, (units.load * load, units.friction * friction), strict=True)
    }
    return Document(answer.state.text).with_kind("target", "sampled", values)


def better_titles(header: Sequence[str]) -> dict[str, str]:
    """Return a suggested title for each column title that is only similar to a known title.

    Examples
    --------
    >>> better_titles(["load_N", "friction_mN"]), better_titles(["Load [N]", "Friction"])
    ({'friction_mN': 'friction_force_mN'}, {'Load [N]': 'load_N', 'Friction': 'friction_force_N'})
    """
    found: dict[str, str] = {}
    for title in header:
        named = TITLE.fullmatch(title)
        if named is None:
            continue
        near = get_close_matches(re.sub(r"\W+", "_", named[1].lower()), KNOWN, 1, LIKE)
        if near:
            name, _, unit = KNOWN[near[0]].rpartition("_")
            better = f"{name}_{named[2] or named[3] or unit}"
            if better != title and better not in header and better not in found.values():
                found[title] = better
    return found


def _offer(header: str) -> str:
    """Return the suggestion to rename columns that follows the error message; "" if there is none."""
    titles = [title.strip() for title in re.split(r"[,;\t]", header)]
    offers = [f"{better} instead of {title[:40]}" for title, better in better_titles(titles).items()]
    return f" Do you mean {' and '.join(offers)}? Change the first line of the file." if offers else ""


def _measured(name: str, law: MeasuredLaw, header: str) -> Points:
    """Return the points of a measured law, with the standard deviations that its table states."""
    stated = ("load_sd" in header, "friction_force_sd" in header or "area_sd" in header)
    known = np.isfinite(law.rescaled_friction)
    sds = (law.rescaled_load_sd, law.rescaled_friction_sd)
    x_sd, y_sd = (sd[known] if given else None for sd, given in zip(sds, stated, strict=True))
    return Points(name, law.rescaled_load[known], law.rescaled_friction[known], x_sd, y_sd)


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
