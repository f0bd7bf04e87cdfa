"""Handles of a target law: the points that the user drags, and the text after a handle has moved."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.explorer.fields import between
from metafem.explorer.lines import LineHandles, PowerHandles
from metafem.explorer.scene import COLUMNS, Handle, Numbers, Scene, members
from metafem.explorer.table import Document
from metafem.files import Specification
from metafem.inversion import Design

# Largest number of points that have handles. With more points, the marks would overlap on the plot, and
# moving a single point would make a spike in the law.
MOST = 200


class PointHandles(Scene):
    """Handles for operating points and samples. Each point moves freely between its neighbours."""

    @property
    def crowd(self) -> int:
        """The number of points of the target if it has too many points for handles, otherwise 0."""
        count = len(self.target.rescaled_load)
        return count if count > MOST else 0

    @property
    def points(self) -> tuple[list[float], list[float]]:
        """Rescaled loads and frictions of the target [mm^2]."""
        return self.target.rescaled_load.tolist(), self.target.rescaled_friction.tolist()

    def handles(self) -> tuple[Handle, ...]:
        """Return a handle for each point, or none for too many points."""
        loads, frictions = self.points
        count = len(loads)
        if self.crowd:
            return ()
        return tuple(
            Handle(f"point-{i}", load, friction, "xy", f"point {i + 1} of {count}")
            for i, (load, friction) in enumerate(zip(loads, frictions, strict=True))
        )

    def curve(self) -> tuple[FloatArray, FloatArray]:
        """Return the points."""
        return self.target.rescaled_load, self.target.rescaled_friction

    def moved(self, handle: Handle, load: float, friction: float, resolution: float) -> tuple[Numbers, float]:
        """Return the points with one point moved, and the resolution of its values."""
        return self._placed(_index(handle.id), self._columns(), (load, friction), resolution)

    def added(self, load: float, friction: float, resolution: float) -> tuple[Numbers, float]:
        """Return the points with one more point, and the resolution of its values."""
        columns, count = self._columns(), len(self.points[0])
        i = sum(other <= load for other in self.points[0])
        for name, entries in columns.items():
            entries.insert(i, 1.0 if name == "weight" else entries[min(i, count - 1)])
        return self._placed(i, columns, (load, friction), resolution)

    def removed(self, id: str) -> Numbers:
        """Return the points without one of them."""
        columns = self._columns()
        if len(self.points[0]) == 1:
            raise InvalidInput("the last point cannot be removed; a target needs at least one")
        for entries in columns.values():
            del entries[_index(id)]
        return columns

    def _placed(
        self, i: int, columns: Numbers, at: tuple[float, float], resolution: float
    ) -> tuple[Numbers, float]:
        """Return the columns with point `i` moved between its neighbours, and the resolution."""
        finest = resolution
        for numbers, value in zip(columns.values(), at, strict=False):
            low, high = [0.0, *numbers][i], [*numbers, math.inf][i + 1]
            if low >= high:  # the friction of noisy samples may decrease
                low, high = 0.0, math.inf
            placed, fine = between(value, low, high, resolution)
            numbers[i] = placed or resolution * numbers[i]  # a single point must not reach 0
            finest = min(finest, fine)
        return columns, finest

    def _columns(self) -> Numbers:
        """Return loads and frictions, and the other columns that the text has."""
        optional = {"weight", "relative_error"} - self.section.keys()
        return members(self.target, [name for name in COLUMNS if name not in optional])


def _index(id: str) -> int:
    """Return the number of the point of a handle."""
    return int(id.removeprefix("point-"))


class BandCurves(Scene):
    """The two curves of a band, without handles; the values are edited in the text."""

    def curve(self) -> tuple[FloatArray, FloatArray]:
        """Return the two curves, with a gap between them."""
        target = self.target
        load, gap = target.rescaled_load, [math.nan]
        return np.concatenate([load, gap, load]), np.concatenate([target.lowest, gap, target.highest])


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
