"""Nodes of the loading or unloading path of adhesive contacts that interact, one after the other."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.models.adhesion.contacts import BoolArray, Condition, Scene, States, joined

# Relative error of a contact radius at the end of a branch. Approach and load are stationary there, so that
# their relative errors are about the square, 1e-10.
LOCATED = 1e-5

# Residual of the nodes, from which the states between them are solved again, and overlap over the largest
# depth of a cap below which it is due to this residual.
NODES, CLOSED = 1e-10, 1e-9

# Trials for one step, each of which halves it or changes its aim: 60 halvings reach rounding.
MOST_TRIALS = 60


def walk(scene: Scene, goal: float, by_load: bool, start: States | None = None) -> States:
    """Return the states from the first contact, or on unloading from `start`, to a load or an approach."""
    sign, first = (1.0 if start is None else -1.0), scene.gap.min()
    nodes = [start or _entered(scene, np.zeros((1, len(scene.gap))), np.array([first]), scene.gap <= first)]
    while sign * (goal - (nodes[-1].load if by_load else nodes[-1].x)[0]) > 0.0:
        nodes += _step(nodes[-1], sign)
        if not nodes[-1].closed.any():
            return joined(nodes[:-1])
    return joined(nodes)


def _step(state: States, sign: float) -> list[States]:
    """Return the next state; at an event, the states before and after it.

    Either the radius of the contact that changes fastest is given, or the next open asperity touches.
    """
    scene, overlap, relative = state.scene, _overlap(state), _relative(state)
    none, one = np.zeros((1, len(overlap))), np.ones(1)
    i, length, breaks = int(relative.argmax()), (1.0 if sign > 0.0 else 0.5), False
    # changes of the approach until open asperities touch, by the tangent
    nearing = sign * (1.0 - scene.displacement(state.fields.rise * state.rate)[0])
    comes = (nearing > 0.0) & np.isfinite(overlap)
    reach = np.where(comes, np.maximum(-overlap, 0.0) / np.where(comes, nearing, 1.0), np.inf)
    k = int(reach.argmin())
    touches = reach[k] * relative[i] < length
    for _ in range(MOST_TRIALS):
        if touches:
            length = min(length, reach[k] * relative[i])
            touching = scene.gap[[k]], -scene.influence[[k]], none, one
            trial = _moved(state, sign * reach[k], touching)
        else:
            trial = _at_radius(state, i, sign * length)
        near = _found(trial) and _change(trial, state) <= 2.0 * length
        if touches and not (near and trial.holds[0]):
            touches = False
            continue
        if not near:
            length *= 0.5
            if length < LOCATED:  # as at the equator of a sphere
                break
            continue
        breaks = not trial.holds[0]
        trial = _end(state, trial, i, sign * length) if breaks else trial
        beyond, rounding = _overlap(trial), CLOSED * trial.fields.depth.max()
        ahead = np.flatnonzero((beyond > rounding) & ~(touches & (np.arange(len(beyond)) == k)))
        if ahead.size:  # the first of these touches before
            share = np.maximum(-overlap[ahead], 0.0)
            share = share / (share + beyond[ahead])
            k, touches = int(ahead[share.argmin()]), True
            reach[k] = share.min() * abs(trial.x[0] - state.x[0])
        elif touches:
            return [trial, _entered(scene, trial.a, trial.x, beyond >= -rounding)]
        else:
            return [trial, _left(trial)] if breaks else [trial]
    raise NotConverged(f"the adhesive contacts cannot be followed beyond an approach of {state.x[0]:.6g} mm")


def _found(state: States) -> bool:
    return bool(state.residual[0] <= 2.0 * NODES)


def _overlap(state: States) -> FloatArray:
    """Return the overlaps of the open asperities with the plane, (n,) [mm]; -inf for contacts."""
    return np.asarray(np.where(state.closed, -np.inf, state.indentation)[0])


def _relative(state: States) -> FloatArray:
    """Return the relative changes of the radii with the approach, (n,) [1/mm]; 0 for open contacts."""
    return np.asarray(state.rate[0] / np.where(state.closed[0], state.a[0], 1.0))


def _change(state: States, before: States) -> float:
    """Return the largest relative change of a contact radius."""
    return float(np.abs(state.a[state.closed] / before.a[state.closed] - 1.0).max())


def _moved(state: States, shift: float, condition: Condition) -> States:
    """Return the state under a condition, guessed by the tangent for a change of the approach."""
    a = np.clip(state.a + shift * state.rate, 0.3 * state.a, 0.5 * (state.a + state.scene.largest_radius))
    return state.scene.solve(state.closed, a, state.x + shift, condition, NODES)


def _at_radius(state: States, i: int, change: float) -> States:
    """Return the state in which the radius of contact i has changed by a part of it."""
    condition = state.scene.at_radius(np.array([i]), state.a[:, i] * (1.0 + change))
    return _moved(state, change * float(state.a[0, i] / state.rate[0, i]), condition)


def _end(state: States, beyond: States, i: int, change: float) -> States:
    """Return the last stable state before `beyond`, in which the radius of contact i differs by `change`.

    dx/da of contact i passes 0 at the end of its branch.
    """
    radius, low, high = state.a[0, i], 0.0, abs(change)
    lengths, values = [0.0, high], [_turn(state, i), _turn(beyond, i)]
    for _ in range(MOST_TRIALS):
        # a secant, aimed a little before the end; halving if another contact breaks
        fall = (values[-2] - values[-1]) / (lengths[-1] - lengths[-2])
        end = lengths[-1] + values[-1] / fall if fall > 0.0 else low
        end = end if low < end < high else 0.5 * (low + high)
        if high - low <= LOCATED or (lengths[-1] == low and end - low <= LOCATED):
            break
        length = max(end - 0.4 * LOCATED, 0.5 * (low + end))
        trial = _at_radius(state, i, radius * (1.0 + np.sign(change) * length) / state.a[0, i] - 1.0)
        if _found(trial) and trial.holds[0]:
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
    scene, closed, relative = state.scene, state.closed.copy(), np.abs(_relative(state))
    while closed.sum() > 1:
        closed[0, np.where(closed[0], relative, -1.0).argmax()] = False
        found = scene.solve(closed.copy(), state.a, state.x, scene.at_approach(state.x), NODES)
        if _found(found) and found.holds[0] and _change(found, state) < 0.5:  # as in a step on unloading
            return found
    return States(scene, closed & False, 0.0 * state.a, state.x, scene.at_approach(state.x))


def _entered(scene: Scene, a: FloatArray, x: FloatArray, entering: BoolArray) -> States:
    """Return the state at an approach after asperities, and others due to them, jumped into contact."""
    while entering.any():
        a = np.where(entering & (a == 0.0), scene.entry_radius, a)
        state = scene.solve(a > 0.0, a, x, scene.at_approach(x), NODES)
        if not (_found(state) and state.holds[0]):
            raise NotConverged(f"no equilibrium after a jump into contact at an approach of {x[0]:.6g} mm")
        a, entering = state.a, _overlap(state) > CLOSED * state.fields.depth.max()
    return state
