"""The law of an answer as data of its plot."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from zlib import crc32

import numpy as np

from metafem._validate import FloatArray
from metafem.explorer.answer import Answer
from metafem.explorer.law.nearest import offer
from metafem.explorer.law.reach import Band
from metafem.explorer.law.shown import EDITED, Units, numbers
from metafem.explorer.text.handles import Handle, crowd
from metafem.inversion import Design, OperatingPoints, SampledLaw, Target
from metafem.inversion.targets.straight import StraightLaw

Line = tuple[FloatArray, FloatArray]

# What the shaded band is: its bounds are proven for independent asperities.
INDEPENDENT = "reach of any surface within the limits"
COUPLED = "reach of independent asperities within the limits"


def law_data(answer: Answer, handles: Sequence[Handle] = ()) -> dict[str, Any]:
    """Return the curves and handles of an answer in the units that are shown."""
    units = Units.of(answer, answer.state.newtons)
    target = None if answer.specification is None else answer.specification.target
    many = 0 if answer.specification is None else crowd(answer.specification)
    data: dict[str, Any] = {
        "number": answer.number,
        # stands for the text: what is said below the plot is valid for it
        "state": crc32(answer.state.text.encode()),
        **units.axes(),
        "achieved": None,
        "model": "",
        "reach": INDEPENDENT,
        "wanted": None,
        "marked": isinstance(target, OperatingPoints) and not many,
        "crowd": f"{many:,} points, too many to drag" if many else "",
        "nearest": None,
        "offer": offer(answer),  # what a button that takes it says
        "refusal": answer.refused,
        # None: those of a text with problems are not known
        "handles": None if target is None else [_handle(handle, units) for handle in handles],
        "cursor": None if answer.state.load is None else numbers([units.load * answer.state.load], EDITED)[0],
    }
    if answer.design is not None:
        law = answer.design.law
        data["achieved"] = units.curve(law.rescaled_load, law.rescaled_friction)
        data["model"] = law.model.name
        data["reach"] = COUPLED if law.model.couples else INDEPENDENT
    if answer.nearest is not None:
        data["nearest"] = units.curve(*answer.nearest) | {"marked": data["marked"]}
    if target is not None:
        line = wanted_line(target, answer.design if answer.current else None)
        if line is not None:
            data["wanted"] = units.curve(*line) | {"knots": _knots(target, line, handles)}
    return data


def band_data(band: Band, units: Units) -> dict[str, Any]:
    """Return a band of laws, its loads and its lowest and highest friction, in the units that are shown."""
    load, low, high = band
    return {
        "x": numbers(units.load * load),
        "low": numbers(units.friction * low),
        "high": numbers(units.friction * high),
    }


def wanted_line(target: Target, design: Design | None) -> Line | None:
    """Return the curve of a target; where it leaves parameters open, with those nearest to the design."""
    if isinstance(target, StraightLaw) and target.load_range is None:
        return None if design is None else _slopes(design)
    law = target.curve()
    if not law.is_open:
        if isinstance(target, StraightLaw):  # a corner is one of the loads
            load = np.array([0.0, *(start for _, start in target.lines[1:]), law.load[-1]])
            return load, target.line(load)
        return law.load, law.base
    if design is None:
        return None
    return law.load, law.law(np.interp(law.load, design.law.rescaled_load, design.law.area))


def _slopes(design: Design) -> Line:
    """Return straight lines with the target slopes along the branches, with a gap between them."""
    load, friction = [], []
    for branch, fit in design.fits:
        ends = np.array(branch.load_range)
        middle = fit.intercept + fit.slope * ends.mean()
        through = middle - branch.slope * ends.mean() if branch.intercept is None else branch.intercept
        load += [*ends, np.nan]
        friction += [*(through + branch.slope * ends), np.nan]
    return np.array(load[:-1]), np.array(friction[:-1])


def _handle(handle: Handle, units: Units) -> dict[str, Any]:
    x, y = numbers([units.load * handle.load, units.friction * handle.friction], EDITED)
    return {"id": handle.id, "x": x, "y": y, "moves": handle.moves, "label": handle.label}


def _knots(target: Target, line: Line, handles: Sequence[Handle]) -> list[str | None] | None:
    """Return the handle at each corner of the target's curve, with which it moves on the screen."""
    if not isinstance(target, (OperatingPoints, SampledLaw)) or len(handles) != len(line[0]):
        return None
    return [handle.id for handle in handles]
