"""Loading and unloading paths of adhesive contacts, and the states on them.

A path consists of stable equilibria at an approach that only increases, or only decreases. An open asperity
jumps into contact where its gap closes; a contact breaks at the end of its branch. Under load control, the
state at a load is the first one of the path with this load: where the load falls along the path, the plane
moves on until the contacts carry the load again, and the area jumps.

A path is known at nodes: at both ends of the pieces in which the contacts do not change, and at some states
between. Without interaction all nodes follow at once, because contacts close at ``x = gap``, and break where
their own indentation is smallest. With interaction they follow one after the other, see `walk`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.optimize import elementwise

from metafem._validate import FloatArray, IntArray
from metafem.errors import InvalidInput, NotConverged
from metafem.models.adhesion.contacts import (
    BoolArray,
    Condition,
    Scene,
    States,
    at_approach,
    at_load,
    at_radius,
    joined,
)
from metafem.models.adhesion.walk import LOCATED, NODES, walk

# Halvings of a part of a path until Newton's method stays in it; doublings from the first contact to a load.
MOST_HALVINGS, MOST_DOUBLINGS = 60, 200

# Numbers in the matrices that are solved together: 32 MiB.
TOGETHER = 4_000_000


class Jump(NamedTuple):
    """A jump of the contact area at a load."""

    load: float  # [mm^2]
    before: float  # area before the jump [mm^2]
    after: float  # area after the jump [mm^2]


@dataclass(frozen=True, eq=False)
class Path:
    """Nodes of a path in their order; `sign` is 1 on loading and -1 on unloading."""

    nodes: States
    sign: float
    by_load: bool  # whether states are found by their load or by their approach

    @cached_property
    def measure(self) -> FloatArray:
        """Load or approach of the nodes, times the sign."""
        return self._measure(self.nodes)

    @cached_property
    def best(self) -> FloatArray:
        """Largest measure up to each node."""
        return np.maximum.accumulate(self.measure)

    def _measure(self, states: States) -> FloatArray:
        return self.sign * (states.load if self.by_load else states.x)

    def _condition(self, goal: FloatArray) -> Condition:
        values = self.sign * goal
        return at_load(values, len(self.nodes.scene.gap)) if self.by_load else at_approach(values)

    def at(self, values: FloatArray) -> States:
        """Return the first states of the path at loads or approaches (k,); open beyond the ends of the path."""
        goal = self.sign * values
        return self._first(goal, np.searchsorted(self.best, goal))

    def _first(self, goal: FloatArray, node: IntArray) -> States:
        """Return the states before the given nodes at which the measure is `goal`."""
        size = max(1, TOGETHER // len(self.nodes.scene.gap) ** 2)
        if self.nodes.scene.influence is not None and len(goal) > size:
            cuts = np.arange(size, len(goal), size)
            return joined(
                [self._first(*part) for part in zip(np.split(goal, cuts), np.split(node, cuts), strict=True)]
            )
        inside = (node < len(self.best)) & ((goal >= self.best[0]) | (self.sign < 0.0))
        node = np.minimum(node, len(self.best) - 1)
        closed = self.nodes.closed[node] & inside[:, None]
        a, x, rows = np.zeros(closed.shape), self.sign * goal, np.flatnonzero(inside)
        if rows.size:
            a[rows], x[rows] = self._between(goal[rows], node[rows])
        return States(self.nodes.scene, closed, a, x, self._condition(goal))

    def _between(self, goal: FloatArray, right: IntArray) -> tuple[FloatArray, FloatArray]:
        """Return contact radii and approaches of the states just before the nodes `right`.

        Newton's method begins between two nodes. Where it leaves the part of the path between them, this part
        is halved.
        """
        nodes, left = self.nodes, np.maximum(right - 1, 0)
        left = np.where((nodes.closed[left] == nodes.closed[right]).all(axis=1), left, right)
        low, high, rows = nodes[left], nodes[right], np.arange(len(goal))
        a, x = high.a.copy(), high.x.copy()
        for _ in range(MOST_HALVINGS):
            before, after = self._measure(low), self._measure(high)
            share = (goal[rows] - before) / np.where(after > before, after - before, np.inf)
            found = low.blended(high, np.clip(share, 0.0, 1.0), self._condition(goal[rows]))
            width = np.abs(high.x - low.x) + 1e-9 * high.fields.depth.max(axis=1)
            inside = (np.abs(found.x - low.x) <= width) & (np.abs(found.x - high.x) <= width)
            good = inside & found.converged & found.holds
            a[rows[good]], x[rows[good]] = found.a[good], found.x[good]
            if good.all():
                return a, x
            rows, low, high = rows[~good], low[~good], high[~good]
            middle = low.blended(high, np.full(len(rows), 0.5), at_approach(0.5 * (low.x + high.x)))
            beyond = self._measure(middle) >= goal[rows]
            low, high = middle.where(~beyond, low), middle.where(beyond, high)
        raise NotConverged("the adhesive contacts cannot be followed between two jumps")

    def jumps(self, goal: float) -> list[Jump]:
        """Return the jumps up to a load."""
        measure, area = self.measure, self.nodes.area
        falls = np.append(measure[1:] < measure[:-1], self.sign < 0.0) & (measure == self.best)
        falls &= measure <= self.sign * goal
        if self.sign > 0.0:  # the first contacts form at zero load
            falls &= measure > 0.0
        level, before = measure[falls], area[falls]
        if self.sign > 0.0:
            level, before = np.append(0.0, level), np.append(0.0, before)
        after = self._first(level, np.searchsorted(self.best, level, side="right")).area
        return [
            Jump(*each)
            for each in zip((self.sign * level).tolist(), before.tolist(), after.tolist(), strict=True)
        ]


def loading(scene: Scene, goal: float, by_load: bool) -> Path:
    """Return the loading path up to a load or an approach."""
    nodes = (_apart if scene.influence is None else walk)(scene, goal, by_load)
    return Path(nodes, 1.0, by_load)


def unloading(scene: Scene, largest: float, goal: float, by_load: bool) -> Path:
    """Return the path from the largest load or approach, reached by loading, back to `goal`."""
    start = loading(scene, largest, by_load).at(np.array([largest]))
    nodes = _apart_back(start) if scene.influence is None else walk(scene, goal, by_load, start)
    return Path(_with_lowest(nodes) if by_load else nodes, -1.0, by_load)


def _apart(scene: Scene, goal: float, by_load: bool) -> States:
    """Return the nodes of the loading path of asperities that do not interact."""
    start = np.unique(scene.gap)
    stop = np.append(start[1:], np.inf)
    closed = scene.gap <= start[:, None]
    # the law may end before the next gap closes
    most = np.where(closed, scene.gap + scene.law.largest_indentation(scene.radius), np.inf).min(axis=1)
    last = int((stop >= most).argmax()) if (stop >= most).any() else len(start) - 1
    stop, closed = stop[:last], closed[: last + 1]
    ends = [_pressed(scene, closed[:-1], stop)] if last else []
    if not ends or (ends[0].load if by_load else stop).max() < goal:
        ends.append(_beyond(scene, closed[-1:], start[last], most[last], goal, by_load))
    else:
        closed = closed[:-1]
    return _pieces(scene, closed, start[: len(closed)], joined(ends), np.zeros((1, len(scene.gap))))


def _pressed(scene: Scene, closed: BoolArray, x: FloatArray) -> States:
    """Return states at approaches (k,) [mm] at which all contacts have d >= 0."""
    plain = scene.law.cap.contact_radius(np.maximum(x[:, None] - scene.gap, 0.0), scene.radius)
    return scene.solve(
        closed, (plain**1.5 + scene.entry_radius**1.5) ** (2.0 / 3.0), x, at_approach(x), NODES
    )


def _beyond(scene: Scene, closed: BoolArray, x: float, most: float, goal: float, by_load: bool) -> States:
    """Return a state beyond the last gap, from x [mm] on, at which a load or an approach is reached."""
    width = float(scene.law.deficit(scene.entry_radius).max())
    x = x if by_load else min(goal, most)
    for _ in range(MOST_DOUBLINGS):
        x = min(x + width, most) if by_load else x
        found = _pressed(scene, closed, np.array([x]))
        if found.residual <= 2.0 * NODES and (found.load if by_load else x) >= goal:
            return found
        if x >= most:
            break
        width *= 2.0
    raise InvalidInput(
        f"the {'load' if by_load else 'approach'} {goal:.4g} mm{'^2' if by_load else ''} needs an approach beyond "
        f"{most:.4g} mm, up to which {scene.law!r} describes all contacts; use lighter loads or a law with a "
        "larger range"
    )


def _apart_back(start: States) -> States:
    """Return the nodes of the unloading path of asperities that do not interact, from a state."""
    scene, held = start.scene, start.closed[0]
    x = scene.gap + scene.law.indentation(scene.break_radius, scene.radius)
    levels = np.unique(x[held])[::-1]
    closed, breaks = held & (x <= levels[:, None]), x == levels[:, None]
    # just before the end of a branch, where the equations are singular
    end = (1.0 + LOCATED) * scene.break_radius
    first = (closed & breaks).argmax(axis=1)
    condition = at_radius(first, end[first], len(x))
    ends = scene.solve(closed, np.where(breaks, end, start.a), levels, condition)
    return _pieces(scene, closed, np.append(start.x, levels[:-1]), ends, start.a)


def _pieces(scene: Scene, closed: BoolArray, start: FloatArray, ends: States, first: FloatArray) -> States:
    """Return the states at the starts and the ends of pieces in turn; new contacts have d = 0.

    first: contact radii (1, n) before the first piece.
    """
    before = np.concatenate([first, ends.a[:-1]])
    a = np.where(closed, np.where(before > 0.0, before, scene.entry_radius), 0.0)
    both = joined([States(scene, closed, a, start, at_approach(start)), ends])
    return both[np.arange(2 * len(closed)).reshape(2, -1).T.ravel()]


def _with_lowest(nodes: States) -> States:
    """Return the nodes of an unloading path, and the states of lowest load between them."""
    rising = nodes.stiffness > 0.0
    same = (nodes.closed[:-1] == nodes.closed[1:]).all(axis=1)
    before = np.flatnonzero(same & rising[:-1] & ~rising[1:])
    if not before.size:
        return nodes
    low, high = nodes[before], nodes[before + 1]
    index = (high.rate / np.where(high.closed, high.a, 1.0)).argmax(axis=1)

    def state(share: FloatArray, rows: IntArray) -> States:
        ends = (each.a[rows, index[rows]] for each in (low, high))
        radius = next(ends) * (1.0 - share) + next(ends) * share
        return low[rows].blended(high[rows], share, at_radius(index[rows], radius, low.a.shape[1]))

    def slope(share: FloatArray, rows: IntArray) -> FloatArray:
        """Return dP/dx over the largest da/dx, which is smooth at the end of a branch."""
        found = state(share, rows)
        return found.stiffness / found.rate.max(axis=1)

    rows = np.arange(len(before))
    share = elementwise.find_root(slope, (np.zeros(len(rows)), np.ones(len(rows))), args=(rows,)).x
    lowest = state(np.where(np.isfinite(share), share, 1.0), rows)
    order = np.argsort(np.append(np.arange(len(nodes.x)), before + 0.5), kind="stable")
    return joined([nodes, lowest])[order]
