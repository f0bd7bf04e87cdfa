"""The curve of a target, and how its corners and handles follow a handle that is dragged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray


class Shift(NamedTuple):
    """How a point follows a handle move (dP, dF): the point moves by (x dP, across dP + y dF)."""

    x: float = 0.0
    across: float = 0.0
    y: float = 0.0


# Shifts of the points that follow one handle: corners of the curve by number, and other handles by id.
Follows = Mapping[int | str, Shift]


@dataclass(frozen=True, eq=False)
class Shape:
    """The curve of a target, made of straight lines between corners, with gaps where a corner is nan.

    Attributes
    ----------
    load, friction : ndarray, (k,)
        Rescaled load and friction of the corners [mm^2]; nan in a gap.
    follows : mapping of str to Follows
        The corners and handles that the browser moves with each handle before the answer is known.
    """

    load: FloatArray
    friction: FloatArray
    follows: Mapping[str, Follows] = field(default_factory=dict)


# Smallest load difference between pointer and pivot at which a branch is turned through the pointer, as a
# fraction of the load difference between handle and pivot. Closer to the pivot, a small move would change the
# slope far too much.
NEAREST = 0.2


@dataclass(frozen=True)
class Branch:
    """A straight branch of a target as the plot draws it.

    Attributes
    ----------
    slope : float
    at : float
        Rescaled load of the handle [mm^2].
    friction : float
        Rescaled friction of the handle [mm^2].
    pivot : float
        Rescaled load of the point about which the handle turns the branch [mm^2].
    low, high : float
        Rescaled loads between which the branch is drawn [mm^2].
    joined : bool
        Whether the branch begins at its pivot on the previous branch and moves with it.
    centred : bool
        Whether the handle is at the middle of the load range that the target states for the branch.
    """

    slope: float
    at: float
    friction: float
    pivot: float
    low: float
    high: float
    joined: bool
    centred: bool

    def friction_at(self, load: float) -> float:
        """Return the rescaled friction of the branch at a rescaled load [mm^2]."""
        return self.friction + self.slope * (load - self.at)

    def turned(self, load: float) -> float:
        """Return the ratio of the friction change at a load to the friction change at the handle."""
        return (load - self.pivot) / (self.at - self.pivot)

    def slope_through(self, load: float, friction: float) -> float:
        """Return the slope of the branch after its handle has moved to a load and friction [mm^2]."""
        run = (load if self.turned(load) >= NEAREST else self.at) - self.pivot
        return (friction - self.friction_at(self.pivot)) / run


class Point(NamedTuple):
    """A point on a branch: the number of the branch, and the rescaled load [mm^2]."""

    branch: int
    load: float


def shape_of(branches: Sequence[Branch], path: Mapping[str, Point]) -> Shape:
    """Return the shape of branches whose crossovers and ends are dragged with the handles in `path`."""
    corners: list[Point | None] = []
    for i, branch in enumerate(branches):
        starts = i == 0 or branch.low > branches[i - 1].high
        if i and starts and not branch.centred:
            corners.append(None)  # branches without a load range need not meet
        corners += [Point(i, branch.low)] * starts + [Point(i, branch.high)]
    load = [np.nan if each is None else each.load for each in corners]
    friction = [np.nan if each is None else branches[each.branch].friction_at(each.load) for each in corners]
    slopes = {f"slope-{i}": Point(i, branch.at) for i, branch in enumerate(branches)}
    points = {**slopes, **path}
    every: list[tuple[int | str, Point]] = [*points.items()]
    every += [(i, each) for i, each in enumerate(corners) if each is not None]
    follows: dict[str, Follows] = {}
    for id, held in points.items():
        shifts = {key: _shift(branches, held, id in slopes, each, key in slopes) for key, each in every}
        if id in slopes:
            del shifts[id]  # this handle is already at the pointer
        follows[id] = {key: shift for key, shift in shifts.items() if shift != Shift()}
    return Shape(np.array(load), np.array(friction), follows)


def _shift(branches: Sequence[Branch], held: Point, turns: bool, point: Point, middle: bool) -> Shift:
    """Return how `point` follows the dragged handle `held`.

    `turns` is whether the handle changes a slope and not a load; `middle` is whether `point` is the slope
    handle of its branch.
    """
    i, j = held.branch, point.branch
    carried = j > i and all(branch.joined for branch in branches[i + 1 : j + 1])
    if turns:
        own = branches[i].turned(point.load) if j == i else 0.0
        return Shift(y=branches[i].turned(branches[i + 1].pivot) if carried else own)
    own_slope, slope = branches[i].slope, branches[j].slope
    joint = i + 1 < len(branches) and branches[i + 1].joined and held.load == branches[i + 1].pivot
    bend = own_slope - branches[i + 1].slope if joint and carried else 0.0
    if middle:
        ends = (branches[j].low, branches[j].high)
        moves = branches[j].centred and (j == i or (carried and joint and j == i + 1)) and held.load in ends
        return Shift(0.5 * moves, bend + 0.5 * moves * slope)
    if point == held:
        return Shift(1.0, own_slope)
    return Shift(across=bend)
