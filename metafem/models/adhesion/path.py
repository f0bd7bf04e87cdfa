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

import numpy as np
from scipy.optimize import elementwise

from metafem._kernels.newton import TOLERANCE
from metafem._validate import FloatArray, IntArray
from metafem.errors import InvalidInput, NotConverged
from metafem.models.adhesion.apart import loaded_apart, loading_pieces
from metafem.models.adhesion.contacts import BoolArray, Scene, States, joined
from metafem.models.adhesion.walk import CLOSED, LOCATED, MOST_TRIALS, NODES, walk


def loaded(scene: Scene, values: FloatArray, by_load: bool = True) -> States:
    """Return the states on loading at increasing loads or approaches (k,)."""
    found = loaded_apart(scene, values) if scene.influence is None and by_load else None
    if found is not None:
        return found
    nodes = (_apart if scene.influence is None else walk)(scene, float(values[-1]), by_load)
    return _on_path(nodes, 1.0, by_load, values)


def unloaded(scene: Scene, values: FloatArray, by_load: bool = True) -> tuple[States, float]:
    """Return the states on unloading from the last of loads or approaches (k,), and the lowest load."""
    start = loaded(scene, values[-1:], by_load)
    nodes = _apart_back(start) if scene.influence is None else walk(scene, float(values[0]), by_load, start)
    nodes = _with_lowest(nodes) if by_load else nodes
    return _on_path(nodes, -1.0, by_load, values), float(nodes.load.min())


def _on_path(nodes: States, sign: float, by_load: bool, values: FloatArray) -> States:
    """Return the first states of a path at loads or approaches (k,); open before loading and after unloading.

    sign: 1 on loading, -1 on unloading. Newton's method begins between the nodes. Where it leaves the part of
    the path between them, the part is halved.
    """

    def measure(states: States) -> FloatArray:
        return sign * (states.load if by_load else states.x)

    scene, best, goal = nodes.scene, np.maximum.accumulate(measure(nodes)), sign * values
    node = np.searchsorted(best, goal)
    inside = (node < len(best)) & ((goal >= best[0]) | (sign < 0.0))
    node = np.minimum(node, len(best) - 1)
    left = np.maximum(node - 1, 0)
    left = np.where((nodes.closed[left] == nodes.closed[node]).all(axis=1), left, node)
    wanted = (scene.at_load if by_load else scene.at_approach)(values)
    shape = len(values), len(scene.gap)
    result = States(scene, nodes.closed[node] & inside[:, None], np.zeros(shape), values.copy(), wanted)
    rows = np.flatnonzero(inside)
    low, high = nodes[left[rows]], nodes[node[rows]]
    for _ in range(MOST_TRIALS):
        if not rows.size:
            return result
        before, after = measure(low), measure(high)
        share = (goal[rows] - before) / np.where(after > before, after - before, np.inf)
        found = low.blended(high, np.clip(share, 0.0, 1.0), result[rows].condition)
        width = np.abs(high.x - low.x) + CLOSED * high.fields.depth.max(axis=1)
        near = (np.abs(found.x - low.x) <= width) & (np.abs(found.x - high.x) <= width)
        good = near & (found.residual <= TOLERANCE) & found.holds
        if good.all() and len(good) == len(values):
            return found
        result.a[rows[good]], result.x[rows[good]] = found.a[good], found.x[good]
        rows, low, high = rows[~good], low[~good], high[~good]
        middle = low.blended(high, np.full(len(rows), 0.5), scene.at_approach(0.5 * (low.x + high.x)))
        beyond = measure(middle) >= goal[rows]
        both, every = joined([low, middle, high]), np.arange(len(rows))
        low = both[every + len(rows) * ~beyond]
        high = both[every + len(rows) * (2 - beyond)]
    raise NotConverged("the adhesive contacts cannot be followed between two jumps")


def _apart(scene: Scene, goal: float, by_load: bool) -> States:
    """Return the nodes of the loading path of asperities that do not interact."""
    start, (closed, stop, most, last) = np.unique(scene.gap), loading_pieces(scene)
    ends = _pressed(scene, closed[:last], stop[:last])
    if (ends.load if by_load else ends.x).max(initial=-np.inf) < goal:
        ends = joined([ends, _beyond(scene, closed[[last]], start[last], most[last], goal, by_load)])
    return _pieces(closed[: len(ends.x)], start[: len(ends.x)], ends, np.zeros((1, len(scene.gap))))


def _pressed(scene: Scene, closed: BoolArray, x: FloatArray) -> States:
    """Return states at approaches (k,) [mm] at which all contacts have d >= 0."""
    plain = scene.law.cap.contact_radius(np.maximum(x[:, None] - scene.gap, 0.0), scene.radius)
    # the guess exceeds a slightly, so that Newton's method for the convex d(a) converges without damping
    a = (plain**1.5 + scene.entry_radius**1.5) ** (2.0 / 3.0)
    return scene.solve(
        closed, np.minimum(a, 0.5 * (plain + scene.largest_radius)), x, scene.at_approach(x), NODES
    )


def _beyond(scene: Scene, closed: BoolArray, x: float, most: float, goal: float, by_load: bool) -> States:
    """Return a state beyond the last gap, from x [mm] on, at which a load or an approach is reached."""
    width = float(scene.law.deficit(scene.entry_radius).max())
    for doubling in range(200):  # up to any load
        x = min(x + width * 2.0**doubling, most) if by_load else goal
        if x > most:
            break
        found = _pressed(scene, closed, np.array([x]))
        if not by_load or found.load[0] >= goal:
            return found
        if x == most:
            break
    what = f"load {goal:.4g} mm^2" if by_load else f"approach {goal:.4g} mm"
    raise InvalidInput(
        f"the {what} needs an approach beyond {most:.4g} mm, up to which {scene.law} describes all "
        "contacts; use lighter loads or a law with a larger range"
    )


def _apart_back(start: States) -> States:
    """Return the nodes of the unloading path of asperities that do not interact, from a state."""
    scene, held = start.scene, start.closed[0]
    x = scene.gap + scene.law.indentation(scene.break_radius, scene.radius)
    levels = np.unique(x[held])[::-1]
    closed, breaks = held & (x <= levels[:, None]), held & (x == levels[:, None])
    # just before the end of a branch, where the equations are singular
    end, first = (1.0 + LOCATED) * scene.break_radius, breaks.argmax(axis=1)
    ends = scene.solve(closed, np.where(breaks, end, start.a), levels, scene.at_radius(first, end[first]))
    return _pieces(closed, np.append(start.x, levels[:-1]), ends, start.a)


def _pieces(closed: BoolArray, start: FloatArray, ends: States, first: FloatArray) -> States:
    """Return the states at the starts and the ends of pieces in turn; new contacts have d = 0.

    first: contact radii (1, n) before the first piece.
    """
    scene, before = ends.scene, np.concatenate([first, ends.a[:-1]])
    a = np.where(before > 0.0, before, scene.entry_radius) * closed
    both = joined([States(scene, closed, a, start, scene.at_approach(start)), ends])
    return both[np.arange(2 * len(start)).reshape(2, -1).T.ravel()]


def _with_lowest(nodes: States) -> States:
    """Return the nodes of an unloading path, and the states of lowest load between them."""
    rising = nodes.stiffness > 0.0
    same = (nodes.closed[:-1] == nodes.closed[1:]).all(axis=1)
    before = np.flatnonzero(same & rising[:-1] & ~rising[1:])
    if not before.size:
        return nodes
    low, high = nodes[before], nodes[before + 1]
    every, index = np.arange(len(before)), (high.rate / np.where(high.closed, high.a, 1.0)).argmax(axis=1)

    def state(share: FloatArray, rows: IntArray) -> States:
        """Return states by the radius of the contact that breaks, which is between those of two nodes."""
        radius = low.a[rows, index[rows]] * (1.0 - share) + high.a[rows, index[rows]] * share
        return low[rows].blended(high[rows], share, nodes.scene.at_radius(index[rows], radius))

    def slope(share: FloatArray, rows: IntArray) -> FloatArray:
        """Return dP/dx over the largest da/dx, which is smooth at the end of a branch."""
        found = state(share, rows)
        return np.asarray(found.stiffness / found.rate.max(axis=1))

    share = elementwise.find_root(slope, (np.zeros(len(every)), np.ones(len(every))), args=(every,)).x
    lowest = state(np.where(np.isfinite(share), share, 1.0), every)
    order = np.argsort(np.append(np.arange(len(nodes.x)), before + 0.5), kind="stable")
    return joined([nodes, lowest])[order]
