"""The curve of a target as its handles make it, and how both follow one that is dragged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray


class Shift(NamedTuple):
    """How a point follows a handle: it moves by x dP and by across dP + y dF, for a move of dP and dF."""

    x: float = 0.0
    across: float = 0.0
    y: float = 0.0


@dataclass(frozen=True)
class Follows:
    """What follows one handle: corners of the curve by number, and handles."""

    corners: Mapping[int, Shift]
    handles: Mapping[str, Shift]


@dataclass(frozen=True, eq=False)
class Shape:
    """The curve of a target: straight lines between corners, with gaps, and what follows each handle.

    Attributes
    ----------
    load, friction : ndarray, (k,)
        Corners, rescaled [mm^2]; not a number in a gap.
    follows : mapping of str to Follows
        What moves with each handle before the answer is known.
    """

    load: FloatArray
    friction: FloatArray
    follows: Mapping[str, Follows] = field(default_factory=dict)

    @property
    def alone(self) -> Shape:
        """The curve, which follows no handle."""
        return Shape(self.load, self.friction)

    @classmethod
    def through(cls, points: Mapping[str, tuple[float, float]]) -> Shape:
        """Return the lines from each of the points, which are handles, to the next."""
        free = Shift(1.0, 0.0, 1.0)
        follows = {id: Follows({i: free}, {}) for i, id in enumerate(points)}
        load, friction = np.array(list(points.values())).T
        return cls(load, friction, follows)


@dataclass(frozen=True)
class Branch:
    """A straight line of a target as it is drawn.

    Attributes
    ----------
    slope : float
    at : float
        Load of its handle, by which it turns about the point at the load `pivot` [mm^2].
    pivot : float
    friction : float
        Where its handle is [mm^2].
    low, high : float
        Loads from and to which it is drawn [mm^2].
    joined : bool
        Whether it begins at its pivot on the branch before it, which carries it.
    centred : bool
        Whether its handle is in the middle between the loads of the target, which can be moved.
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
        """Return the friction of the line [mm^2]."""
        return self.friction + self.slope * (load - self.at)

    def turned(self, load: float) -> float:
        """Return how far a point at a load is moved for each move of the handle."""
        return (load - self.pivot) / (self.at - self.pivot)


class Point(NamedTuple):
    """A point of a branch that is given by its number."""

    branch: int
    load: float


def shape_of(branches: Sequence[Branch], path: Mapping[str, Point]) -> Shape:
    """Return the shape of branches whose ends are dragged at the handles of `path`."""
    corners: list[Point | None] = []
    for i, branch in enumerate(branches):
        starts = i == 0 or branch.low > branches[i - 1].high
        if i and starts and not branch.centred:
            corners.append(None)  # without a range of loads the lines do not meet
        corners += [Point(i, branch.low)] * starts + [Point(i, branch.high)]
    load = [np.nan if each is None else each.load for each in corners]
    friction = [np.nan if each is None else branches[each.branch].friction_at(each.load) for each in corners]
    slopes = {f"slope-{i}": Point(i, branch.at) for i, branch in enumerate(branches)}
    points = {**slopes, **path}
    follows = {}
    for id in points:
        turns = id in slopes
        moved = {name: _shift(branches, points[id], turns, points[name], name in slopes) for name in points}
        if turns:
            moved.pop(id)  # it is where the hand is
        bent = {
            i: _shift(branches, points[id], turns, each, False)
            for i, each in enumerate(corners)
            if each is not None
        }
        still = Shift()
        follows[id] = Follows(
            {i: shift for i, shift in bent.items() if shift != still},
            {name: shift for name, shift in moved.items() if shift != still},
        )
    return Shape(np.array(load), np.array(friction), follows)


def _shift(branches: Sequence[Branch], held: Point, turns: bool, point: Point, middle: bool) -> Shift:
    """Return how a point follows the slope or the load that is held; a `middle` is one of its branch."""
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
