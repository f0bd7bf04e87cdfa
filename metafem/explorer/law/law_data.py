"""The law of an answer as data for the plot."""

from __future__ import annotations

from typing import Any
from zlib import crc32

from metafem.explorer.answer import Answer
from metafem.explorer.law.nearest import offer
from metafem.explorer.law.reach import Band
from metafem.explorer.law.shown import EDITED, Units, numbers
from metafem.explorer.text.handles import drawn, scene_of
from metafem.explorer.text.marks import Handle
from metafem.explorer.text.shape import Follows
from metafem.inversion import OperatingPoints

# Labels of the shaded band. Its bounds are proven for independent asperities.
INDEPENDENT = "possible at one load"
COUPLED = "possible at one load for independent asperities"

# Text after the refusal of a draft if no bound proves the refusal.
SEARCHED = "A longer search follows."


def law_data(answer: Answer) -> dict[str, Any]:
    """Return the curves and handles of an answer in the units of the axes."""
    units = Units.of(answer, answer.state.newtons)
    own = Units.of_design(answer, answer.state.newtons)
    scene = answer.specification and scene_of(answer.state.text, answer.specification, answer.design)
    handles, shape = drawn(scene) if scene else ((), None)
    target, many = (scene.target, scene.crowd) if scene else (None, 0)
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


def band_data(band: Band, units: Units) -> dict[str, Any]:
    """Return loads, lowest and highest friction of a band of laws, in the units of the axes."""
    load, low, high = band
    return {
        "x": numbers(units.load * load),
        "low": numbers(units.friction * low),
        "high": numbers(units.friction * high),
    }


def _handle(handle: Handle, units: Units) -> dict[str, Any]:
    x, y = numbers([units.load * handle.load, units.friction * handle.friction], EDITED)
    return {
        "id": handle.id,
        "x": x,
        "y": y,
        "moves": handle.moves,
        "label": handle.label,
        "carried": handle.carried,
    }


def _follows(follows: Follows, units: Units) -> dict[str, Any]:
    """Return the factors by which corners and handles follow a move of a handle, in the units of the axes."""

    across = units.friction / units.load
    rows = [
        [key, *numbers([shift.x, shift.across * across, shift.y], EDITED)] for key, shift in follows.items()
    ]
    corners = [row for row in rows if isinstance(row[0], int)]
    return {"corners": corners, "handles": [row for row in rows if row not in corners]}
