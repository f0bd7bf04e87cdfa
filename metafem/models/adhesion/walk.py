"""Nodes of the loading or unloading path of adhesive contacts that interact, one after the other."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.models.adhesion.contacts import (
    BoolArray,
    Condition,
    Scene,
    States,
    at_approach,
    at_radius,
    joined,
)

# Relative change of the radius of the contact that changes fastest, in a step on loading and on unloading.
FORWARD, BACK = 1.0, 0.5

# Relative error of a contact radius at the end of a branch. Approach and load are stationary there, so that their
# relative errors are about the square, 1e-10.
LOCATED = 1e-5

# Residual of the nodes, which are only guesses of states, and overlap over the largest depth of a cap below which
# it is due to this residual.
NODES, CLOSED = 1e-10, 1e-9

# Trials for one step, each of which shortens it or changes its aim.
MOST_TRIALS = 60


def walk(scene: Scene, goal: float, by_load: bool, start: States | None = None) -> States:
    """Return the states from the first contact, or on unloading from `start`, to a load or an approach."""
    sign, first = (1.0 if start is None else -1.0), scene.gap.min()
    nodes = [start or _entered(scene, np.zeros((1, len(scene.gap))), first, scene.gap <= first)]
    while (
        nodes[-1].closed.any()
        and sign * (goal - float(nodes[-1].load[0] if by_load else nodes[-1].x[0])) > 0.0
    ):
        nodes += _step(nodes[-1], sign)
    return joined(nodes if nodes[-1].closed.any() else nodes[:-1])


def _step(state: States, sign: float) -> list[States]:
    """Return the next state; at an event, the states before and after it.

    Either the radius of the contact that changes fastest is given, or the next open asperity touches.
    """
    scene, relative = state.scene, _relative(state)
    i, reach = int(relative.argmax()), _reach(state, sign)
    length, k = (FORWARD if sign > 0.0 else BACK), int(reach.argmin())
    touches = reach[k] * relative[i] < length
    for _ in range(MOST_TRIALS):
        if touches:
            trial = _moved(state, sign * reach[k], _touching(scene, k))
            length = min(length, reach[k] * relative[i])
        else:
            trial = _at_radius(state, i, sign * length)
        near = bool(trial.residual[0] <= 2.0 * NODES) and _change(trial, state).max() <= 2.0 * length
        breaks = near and not trial.holds[0]
        if touches and not (near and trial.holds[0]):
            touches = False
            continue
        if not near:
            length *= 0.5
            continue
        if breaks:
            trial = _end(state, trial, i, sign * length)
        overlap = trial.overlap[0] - CLOSED * trial.fields.depth.max()
        overlap[k] = -np.inf if touches else overlap[k]
        ahead = np.flatnonzero(overlap > 0.0)
        if ahead.size:
            gap = np.maximum(-state.overlap[0, ahead], 0.0)
            share = gap / (gap + overlap[ahead])
            k, touches = int(ahead[share.argmin()]), True
            reach[k] = share.min() * abs(float(trial.x[0] - state.x[0]))
            continue
        if touches:
            entering = trial.overlap[0] >= -CLOSED * trial.fields.depth.max()
            return [trial, _entered(scene, trial.a, float(trial.x[0]), entering)]
        return [trial, _left(trial)] if breaks else [trial]
    raise NotConverged(f"the adhesive contacts cannot be followed beyond an approach of {state.x[0]:.6g} mm")


def _relative(state: States) -> FloatArray:
    """Return the relative changes of the radii with the approach, (n,) [1/mm]; 0 for open contacts."""
    return np.asarray(state.rate[0] / np.where(state.closed[0], state.a[0], 1.0))


def _reach(state: States, sign: float) -> FloatArray:
    """Return the changes of the approach (n,) [mm] until open asperities touch, by the tangent."""
    nearing = sign * (1.0 - state.scene.displacement(state.fields.rise * state.rate))
    gap = -state.overlap
    return np.where(
        (nearing > 0.0) & ~state.closed, np.maximum(gap, 0.0) / np.where(nearing > 0.0, nearing, 1.0), np.inf
    )[0]


def _touching(scene: Scene, k: int) -> Condition:
    """Return the condition that the open asperity k touches the plane."""
    return Condition(scene.gap[[k]], by_load=-scene.influence[[k]], by_approach=1.0)


def _moved(state: States, shift: float, condition: Condition) -> States:
    """Return the state under a condition, guessed by the tangent for a change of the approach."""
    a = np.maximum(state.a + shift * state.rate, 0.3 * state.a)
    return state.moved(a, state.x + shift, condition, NODES)


def _at_radius(state: States, i: int, change: float) -> States:
    """Return the state in which the radius of contact i has changed by a part of it."""
    condition = at_radius(np.array([i]), state.a[:, i] * (1.0 + change), state.a.shape[1])
    return _moved(state, change * float(state.a[0, i] / state.rate[0, i]), condition)


def _change(state: States, before: States) -> FloatArray:
    """Return the relative changes of the radii of the contacts."""
    return np.abs(state.a[state.closed] / before.a[state.closed] - 1.0)


def _end(state: States, beyond: States, i: int, change: float) -> States:
    """Return the last stable state before an unstable one, `beyond`; the radius of contact i differs by `change`.

    dx/da of contact i passes 0 at the end of its branch.
    """
    radius, low, high = state.a[0, i], 0.0, abs(change)
    lengths, values = [0.0, high], [_turn(state, i), _turn(beyond, i)]
    for _ in range(MOST_TRIALS):
        fall = (values[-2] - values[-1]) / (lengths[-1] - lengths[-2])
        # a secant, aimed a little before the end; halving if another direction than that of i becomes unstable
        end = lengths[-1] + values[-1] / fall if fall > 0.0 and values[-1] * values[-2] != 0.0 else np.nan
        if not low < end < high:
            end = 0.5 * (low + high)
        if high - low <= LOCATED or (lengths[-1] == low and end - low <= LOCATED):
            break
        length = max(end - 0.4 * LOCATED, 0.5 * (low + end))
        trial = _at_radius(state, i, radius * (1.0 + np.sign(change) * length) / state.a[0, i] - 1.0)
        if trial.residual[0] <= 2.0 * NODES and trial.holds[0]:
            state, low = trial, length
        else:
            high = length
        lengths.append(length)
        values.append(_turn(trial, i))
    return state


def _turn(state: States, i: int) -> float:
    """Return dx/da of contact i times the root of a, which is almost linear in a."""
    return float(np.sqrt(state.a[0, i]) / state.rate[0, i])


def _left(state: States) -> States:
    """Return the state after the contact that changes fastest broke, and all that break with it."""
    closed, relative = state.closed[0].copy(), np.abs(_relative(state))
    while closed.any():
        closed[np.where(closed, relative, -1.0).argmax()] = False
        if not closed.any():
            break
        found = state.scene.solve(closed[None], state.a * closed, state.x, at_approach(state.x), NODES)
        if found.residual[0] <= 2.0 * NODES and found.holds[0] and _change(found, state).max() < BACK:
            return found
    return States(state.scene, closed[None], 0.0 * state.a, state.x, at_approach(state.x))


def _entered(scene: Scene, a: FloatArray, x: float, entering: BoolArray) -> States:
    """Return the state at an approach after asperities, and others due to them, jumped into contact."""
    approach = np.array([x])
    while True:
        a = np.where(entering & (a == 0.0), scene.entry_radius, a)
        state = scene.solve(a > 0.0, a, approach, at_approach(approach), NODES)
        if not (state.residual[0] <= 2.0 * NODES and state.holds[0]):
            raise NotConverged(
                f"no equilibrium after an asperity came into contact at an approach of {x:.6g} mm"
            )
        entering = state.overlap > CLOSED * state.fields.depth.max()
        if not entering.any():
            return state
        a = state.a
