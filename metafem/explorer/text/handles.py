"""Handles of a target law: the points at which it is dragged, and the text after they have moved."""

from __future__ import annotations

import math

from metafem.errors import InvalidInput
from metafem.explorer.text.document import Document
from metafem.explorer.text.lines import LineHandles
from metafem.explorer.text.marks import Handle, Marks, Scene
from metafem.explorer.text.points import PointHandles
from metafem.explorer.text.power import PowerHandles
from metafem.explorer.text.shape import Shape
from metafem.files import Specification
from metafem.inversion import Design, OperatingPoints, SampledLaw

__all__ = ["Handle", "added", "crowd", "drawn", "handles", "moved", "removed"]

# Relative resolution of a value that is dragged: a pixel of a plot of a thousand.
RESOLUTION = 1e-3

# Most points that are handles. More are closer together on a plot than the marks of two, and a hand that
# moves one of them makes a spike.
MOST = 200

MARKS: dict[str, type[Marks]] = {
    "operating-points": PointHandles,
    "sampled": PointHandles,
    "linear": LineHandles,
    "bilinear": LineHandles,
    "multilinear": LineHandles,
    "power": PowerHandles,
}


def handles(text: str, specification: Specification | None, design: Design | None) -> tuple[Handle, ...]:
    """Return the handles of the target of a specification; none if it has problems or a crowd of points.

    Parameters
    ----------
    text : str
        The text of the specification.
    specification : Specification or None
        What the text holds, None if it has problems.
    design : Design or None
        The last design, which has the intercepts that a target leaves open.

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
    """Return the handles of a target and its curve; none of a specification that has problems."""
    if specification is None:
        return (), None
    marks = _marks(text, specification, design)
    shape = marks.shape()
    return ((), shape.alone) if crowd(specification) else (marks.handles(), shape)


def crowd(specification: Specification) -> int:
    """Return the number of points of a target that has too many for handles, else 0."""
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

    Values keep their units. Loads stay between those of their neighbours, and so does the friction of points.
    All steps of one drag are given the text, specification and design with which the drag began: a later
    design has other intercepts, and the result then depends on the path of the hand.

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
    _refuse_negative(load, friction)
    marks = _marks(text, specification, design)
    handle = next((handle for handle in marks.handles() if handle.id == id), None)
    if handle is None:
        raise InvalidInput(f'the target has no handle "{id:.40}"')
    return marks.scene.written(marks.moved(handle, load, friction, resolution))


def added(
    text: str,
    specification: Specification | None,
    load: float,
    friction: float,
    resolution: float = RESOLUTION,
) -> str:
    """Return the text with a further point of the target at a rescaled load and friction [mm^2].

    Raises
    ------
    InvalidInput
        For a target that is not given by points.
    """
    _refuse_negative(load, friction)
    marks = _marks(text, specification, None)
    return marks.scene.written(marks.added(load, friction, resolution))


def removed(text: str, specification: Specification | None, id: str) -> str:
    """Return the text without a point of the target, or without what is optional.

    Raises
    ------
    InvalidInput
        For the only point, and for a handle of something that the target needs.
    """
    marks = _marks(text, specification, None)
    return marks.scene.written(marks.removed(id))


def _marks(text: str, specification: Specification | None, design: Design | None) -> Marks:
    if specification is None:
        raise InvalidInput("the specification has problems; correct them before the law is dragged")
    scene = Scene(Document(text), specification, design)
    return MARKS[scene.kind](scene)


def _refuse_negative(load: float, friction: float) -> None:
    for name, value in (("load", load), ("friction", friction)):
        if not (math.isfinite(value) and value >= 0.0):
            raise InvalidInput(f"{name} = {value:g} mm^2 must be a finite number of at least 0")
