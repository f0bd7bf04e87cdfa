"""Handles of a target law: the points that the user drags, and the text after a handle has moved."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from metafem.errors import InvalidInput
from metafem.explorer.text.document import Document
from metafem.explorer.text.lines import LineHandles
from metafem.explorer.text.marks import Handle, Scene
from metafem.explorer.text.points import BandCurves, PointHandles
from metafem.explorer.text.power import PowerHandles
from metafem.explorer.text.shape import Shape
from metafem.files import Specification
from metafem.inversion import Design, OperatingPoints, SampledLaw

__all__ = ["Handle", "added", "crowd", "drawn", "handles", "moved", "removed"]

# Relative resolution of a dragged value: one pixel of a plot that is a thousand pixels wide.
RESOLUTION = 1e-3

# Relative resolution of a new point on the law of the last design; with fewer digits no surface may reach it.
SNAPPED = 1e-6

# Largest number of points that have handles. With more points, the marks would overlap on the plot, and
# moving a single point would make a spike in the law.
MOST = 200

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


def handles(text: str, specification: Specification | None, design: Design | None) -> tuple[Handle, ...]:
    """Return the handles of a target; none if the specification has problems or the target too many points.

    Parameters
    ----------
    text : str
        The text of the specification.
    specification : Specification or None
        The specification in the text; None if the text has problems.
    design : Design or None
        The last design, which supplies the intercepts that the target leaves open.

    Examples
    --------
    >>> from metafem.files import demo_text, parsed
    >>> text = demo_text("operating-points")
    >>> [handle.load for handle in handles(text, parsed(text), None)]
    [0.144, 0.336, 0.649]
    """
    return drawn(text, specification, design)[0]


def drawn(
    text: str, specification: Specification | None, design: Design | None
) -> tuple[tuple[Handle, ...], Shape | None]:
    """Return the handles and the curve of a target; no handles and None if the specification has problems.

    A target with too many points has a curve but no handles.
    """
    if specification is None:
        return (), None
    marks = _marks(text, specification, design)
    shape = marks.shape()
    return ((), replace(shape, follows={})) if crowd(specification) else (marks.handles(), shape)


def crowd(specification: Specification) -> int:
    """Return the number of points of the target if it has too many points for handles, otherwise 0."""
    target = specification.target
    count = len(target.rescaled_load) if isinstance(target, (OperatingPoints, SampledLaw)) else 0
    return count if count > MOST else 0


def moved(
    text: str,
    specification: Specification | None,
    design: Design | None,
    id: str,
    load: float,
    friction: float,
    resolution: float = RESOLUTION,
) -> str:
    """Return the text after a handle has moved to a rescaled load and friction [mm^2].

    Values keep their units. The load of a handle stays between the loads of its neighbours, and so does the
    friction of a point. Every step of a drag must use the text, specification and design from the start of
    the drag: a later design has other intercepts, so the result would depend on the path of the pointer.

    Raises
    ------
    InvalidInput
        If there is no such handle, or for values that are negative or not finite.

    Examples
    --------
    >>> from metafem.files import demo_text, parsed
    >>> text = demo_text("operating-points")
    >>> new = moved(text, parsed(text), None, "point-1", 0.40004, 1.9)
    >>> parsed(new).target.rescaled_load
    array([0.144, 0.4  , 0.649])
    """
    _refuse_negative(load=load, friction=friction)
    marks = _marks(text, specification, design)
    handle = next((handle for handle in marks.handles() if handle.id == id), None)
    if handle is None:
        raise InvalidInput(f'the target has no handle "{id:.40}"')
    return marks.written(*marks.moved(handle, load, friction, resolution))


def added(
    text: str,
    specification: Specification | None,
    load: float,
    friction: float,
    resolution: float = RESOLUTION,
    design: Design | None = None,
    near: float = 0.0,
) -> str:
    """Return the text with one more point of the target at a rescaled load and friction [mm^2].

    If its friction differs by at most `near` from that of the law of `design`, the point is on this law.

    Raises
    ------
    InvalidInput
        If the target does not consist of points, or for values that are negative or not finite.
    """
    _refuse_negative(load=load, friction=friction)
    marks = _marks(text, specification, design)
    achieved = marks.achieved(np.array([load])) if near > 0.0 and load > 0.0 else None
    if achieved is not None and abs(achieved[0] - friction) <= near:
        friction, resolution = float(achieved[0]), SNAPPED
    numbers, fine = marks.added(load, friction, resolution)
    drawn_by_hand = marks.kind == "operating-points" and len(numbers["rescaled_load"]) >= CURVE
    return marks.written(numbers, fine, "sampled" if drawn_by_hand else "")


def removed(text: str, specification: Specification | None, id: str) -> str:
    """Return the text without a point or an optional parameter of the target.

    Raises
    ------
    InvalidInput
        For the last remaining point, and for the handle of a required parameter.
    """
    marks = _marks(text, specification, None)
    return marks.written(marks.removed(id), RESOLUTION)


def _marks(text: str, specification: Specification | None, design: Design | None) -> Scene:
    if specification is None:
        raise InvalidInput("the specification has problems; correct them before the law is dragged")
    document = Document(text)
    return MARKS[document.value("target.kind")](document, specification, design)


def _refuse_negative(**at: float) -> None:
    for name, value in at.items():
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidInput(f"{name} = {value:g} mm^2 must be a finite number of at least 0")
