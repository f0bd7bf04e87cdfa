"""The law of an answer as data for the plot."""

from __future__ import annotations

from typing import Any
from zlib import crc32

from metafem.explorer.answer import Answer
from metafem.explorer.law.nearest import offer
from metafem.explorer.law.reach import Band
from metafem.explorer.law.shown import EDITED, Units, numbers
from metafem.explorer.text.handles import Handle, crowd, drawn
from metafem.explorer.text.shape import Follows, Shift
from metafem.inversion import OperatingPoints

# Labels of the shaded band. Its bounds are proven for independent asperities.
INDEPENDENT = "possible at one load"
COUPLED = "possible at one load for independent asperities"

# Text after the refusal of a draft if no bound proves the refusal.
SEARCHED = "A longer search follows."


def law_data(answer: Answer) -> dict[str, Any]:
    """Return the curves and handles of an answer in the units of the axes."""
    handles, shape = drawn(answer.state.text, answer.specification, answer.design)
    units = Units.of(answer, answer.state.newtons)
    own = Units.of_design(answer, answer.state.newtons)
    target = None if answer.specification is None else answer.specification.target
    many = 0 if answer.specification is None else crowd(answer.specification)
    data: dict[str, Any] = {
        "number": answer.number,
        # checksum of the text: messages below the plot are valid for this text only
        "state": crc32(answer.state.text.encode()),
        **units.axes(),
        "achieved": None,
        "model": "",
        "reach": INDEPENDENT,
        "wanted": None,
        "marked": isinstance(target, OperatingPoints) and not many,
        "crowd": f"{many:,} points, too many to drag" if many else "",
        "nearest": None,
        "offer": offer(answer),  # label of the button that adopts the nearest law
        "refusal": f"{answer.refused} {SEARCHED}" if answer.undecided else answer.refused,
        "undecided": answer.undecided,
        # None if the text has problems, because its handles are then unknown
        "handles": None if target is None else [_handle(handle, units) for handle in handles],
        "load_scale": own.load,  # units of the load axis per rescaled load
        "cursor": None if answer.state.load is None else numbers([own.load * answer.state.load], EDITED)[0],
    }
    if answer.design is not None:
        law = answer.design.law
        data["achieved"] = own.curve(law.rescaled_load, law.rescaled_friction)
        data["model"] = f"{law.model.name}, draft" if answer.simplified else law.model.name
        data["reach"] = COUPLED if law.model.couples else INDEPENDENT
    if answer.nearest is not None:
        data["nearest"] = units.curve(*answer.nearest) | {"marked": data["marked"]}
    if shape is not None:
        data["wanted"] = {
            **units.curve(shape.load, shape.friction),
            "follows": {id: _follows(each, units) for id, each in shape.follows.items()},
        }
    return data


def band_data(band: Band, units: Units, **more: Any) -> dict[str, Any]:
    """Return loads, lowest and highest friction of a band of laws, in the units of the axes."""
    load, low, high = band
    x, y = numbers(units.load * load), units.friction
    return {"x": x, "low": numbers(y * low), "high": numbers(y * high), **more}


def _handle(handle: Handle, units: Units) -> dict[str, Any]:
    """Return a handle at its place in the units of the axes."""
    x, y = numbers([units.load * handle.load, units.friction * handle.friction], EDITED)
    return {**vars(handle), "x": x, "y": y}


def _follows(follows: Follows, units: Units) -> dict[str, Any]:
    """Return the factors by which corners and handles follow a move of a handle, in the units of the axes."""

    def factors(shift: Shift) -> list[float | None]:
        return numbers([shift.x, shift.across * units.friction / units.load, shift.y], EDITED)

    return {
        "corners": [[number, *factors(shift)] for number, shift in follows.corners.items()],
        "handles": [[id, *factors(shift)] for id, shift in follows.handles.items()],
    }
