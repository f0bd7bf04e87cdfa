"""The law of an answer as data for the plot."""

from __future__ import annotations

from typing import Any
from zlib import crc32

from metafem.explorer.answer import Answer
from metafem.explorer.certainty.band import Band
from metafem.explorer.law.nearest import offer
from metafem.explorer.law.shown import EDITED, Units, numbers
from metafem.explorer.text.handles import scene_of
from metafem.explorer.text.marks import Handle
from metafem.inversion import OperatingPoints

# Text after the refusal of a draft if no bound proves the refusal.
SEARCHED = "A longer search follows."


def law_data(answer: Answer) -> dict[str, Any]:
    """Return the curves and handles of an answer in the units of the axes, and its target as ``base``."""
    units = Units.of(answer.template, answer.state.newtons)
    own = Units.of_design(answer, answer.state.newtons)
    given = answer.specification
    scene = None if given is None else scene_of(answer.state.text, given, answer.design)
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
        "refusal": f"{answer.refused} {SEARCHED}" if answer.undecided else answer.refused,
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
