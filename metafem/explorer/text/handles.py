"""Handles of a target law: the points that the user drags, and the text after a handle has moved."""

from __future__ import annotations

import math

import numpy as np

from metafem.errors import InvalidInput
from metafem.explorer.text.document import Document
from metafem.explorer.text.lines import LineHandles
from metafem.explorer.text.marks import Handle, Scene
from metafem.explorer.text.points import BandCurves, PointHandles
from metafem.explorer.text.power import PowerHandles
from metafem.files import Specification
from metafem.inversion import Design

# Relative resolution of a dragged value: one pixel of a plot that is a thousand pixels wide.
RESOLUTION = 1e-3

# Relative resolution of a new point on the law of the last design; with fewer digits no surface may reach it.
SNAPPED = 1e-6

# From this number of points on, points that are drawn become a curve that is approximated.
CURVE = 5

MARKS: dict[str, type[Scene]] = {
    "operating-points": PointHandles,
    "sampled": PointHandles,
    "linear": LineHandles,
    "bilinear": LineHandles,
    "multilinear": LineHandles,
    "power": PowerHandles,
    "band": BandCurves,
}


def scene_of(text: str, specification: Specification | None, design: Design | None) -> Scene:
    """Return the target of a text with its handles.

    `design` is the last design, which supplies the intercepts that the target leaves open. Every step of a
    drag must use the same scene: a later design has other intercepts, so the result would depend on the path
    of the pointer.

    Raises
    ------
    InvalidInput
        If there is no specification because the text has problems.

    Examples
    --------
    >>> from metafem.files import demo_text, parsed
    >>> text = demo_text("operating-points")
    >>> scene = scene_of(text, parsed(text), None)
    >>> [handle.load for handle in scene.handles()]
    [0.144, 0.336, 0.649]
    >>> parsed(moved(scene, "point-1", 0.40004, 1.9)).target.rescaled_load
    array([0.144, 0.4  , 0.649])
    """
    if specification is None:
        raise InvalidInput("the specification has problems; correct them before the law is dragged")
    document = Document(text)
    return MARKS[document.value("target.kind")](document, specification, design)


def moved(scene: Scene, id: str, load: float, friction: float, resolution: float = RESOLUTION) -> str:
    """Return the text after a handle has moved to a rescaled load and friction [mm^2].

    Values keep their units. The load of a handle stays between the loads of its neighbours, and so does the
    friction of a point.

    Raises
    ------
    InvalidInput
        If there is no such handle, or for values that are negative or not finite.
    """
    _refuse_negative(load=load, friction=friction)
    return scene.written(*scene.moved(_handle(scene, id), load, friction, resolution))


def added(scene: Scene, load: float, friction: float, near: float = 0.0) -> str:
    """Return the text with one more point of the target at a rescaled load and friction [mm^2].

    If its friction differs by at most `near` from that of the law of the last design, the point is on this
    law.

    Raises
    ------
    InvalidInput
        If the target does not consist of points, or for values that are negative or not finite.
    """
    _refuse_negative(load=load, friction=friction)
    achieved, resolution = scene.achieved(np.array([load])) if near > 0.0 and load > 0.0 else None, RESOLUTION
    if achieved is not None and abs(achieved[0] - friction) <= near:
        friction, resolution = float(achieved[0]), SNAPPED
    numbers, fine = scene.added(load, friction, resolution)
    drawn_by_hand = scene.kind == "operating-points" and len(numbers["rescaled_load"]) >= CURVE
    return scene.written(numbers, fine, "sampled" if drawn_by_hand else "")


def removed(scene: Scene, id: str) -> str:
    """Return the text without a point or an optional parameter of the target.

    Raises
    ------
    InvalidInput
        If there is no such handle; for the last remaining point; and for the handle of a required parameter.
    """
    return scene.written(scene.removed(_handle(scene, id).id), RESOLUTION)


def _handle(scene: Scene, id: str) -> Handle:
    """Return a handle, or raise InvalidInput if the target does not have it."""
    for handle in scene.handles():
        if handle.id == id:
            return handle
    raise InvalidInput(f'the target has no handle "{id:.40}"')


def _refuse_negative(**at: float) -> None:
    for name, value in at.items():
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidInput(f"{name} = {value:g} mm^2 must be a finite number of at least 0")
