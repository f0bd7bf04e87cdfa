"""Loading path of adhesive contacts that interact.

The path consists of stable equilibria at fixed approach. An open asperity jumps into contact where its gap
closes, and the total load decreases. Under load control the plane then advances until the contacts carry the
load again. The state at a load is therefore the first point of the path with this load, and is stable under
load control.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.errors import NotConverged
from metafem.models.adhesion.notes import Jump
from metafem.models.adhesion.scene import Contacts, Scene
from metafem.models.adhesion.solve import (
    CLOSED,
    Condition,
    State,
    at_approach,
    at_load,
    solve,
    touching,
)

# Largest relative increase of a contact radius in one step, as predicted by the tangent.
FORWARD = 3.0

# Maximum number of sets of contacts that are tried from a guess. In the first set, an asperity is in contact
# if its guessed contact radius exceeds SURE times the radius after a jump into contact.
MOST_TRIALS, SURE = 8, 1.5

# Safety factor of the estimated increase of the approach by a new contact.
DOUBT = 2.0

# Maximum number of steps between two loads, and maximum number of trials in a search for one state.
MOST_STEPS = 1000
MOST_SEARCHES = 60


class Goal(NamedTuple):
    """A load [mm^2] or an approach [mm] at which the state is required."""

    value: float
    by_load: bool

    def condition(self) -> Condition:
        """Return the goal as a condition for `solve`."""
        return at_load(self.value) if self.by_load else at_approach(self.value)

    def measure(self, state: State) -> float:
        """Return the load [mm^2] or the approach [mm] of a state."""
        return state.load if self.by_load else state.x

    def stable(self, state: State) -> bool:
        """Return whether the contacts are stable under load control or approach control."""
        return state.stable if self.by_load else state.holds

    def shift(self, state: State) -> float:
        """Return the change of the approach [mm] to the goal, as predicted by the tangent."""
        missing = self.value - self.measure(state)
        return missing / state.stiffness if self.by_load else missing


@dataclass
class Loading:
    """The loading path of one surface; `state` is None while no asperity is in contact."""

    scene: Scene
    record: bool = True  # whether jumps are recorded
    state: State | None = None
    jumps: list[Jump] = field(default_factory=list)
    extreme: float = (
        -np.inf
    )  # load up to which the path is known: the largest on loading, the lowest on unloading

    def press(self, goal: Goal) -> State | None:
        """Follow the path to a goal; return the state, or None if no asperity is in contact there."""
        for _ in range(MOST_STEPS):
            if self.state is None:
                if not goal.by_load and goal.value < self._first_touch():
                    return None
                self._enter_first()
                continue
            state = self.state
            if goal.by_load and goal.measure(state) >= goal.value:
                return state
            trial = self._forward(state, goal)
            if trial is None:
                raise NotConverged(f"the adhesive contacts cannot be followed beyond {state.x:.6g} mm")
            if trial.entering.size:
                self._enter(state, trial, goal)
                continue
            self.state = trial
            if goal.measure(trial) >= goal.value - self._unit(trial, goal):
                return trial
        raise NotConverged("the adhesive contacts do not settle")

    def press_near(self, goal: Goal, guess: FloatArray) -> State | None:
        """Return the state at a goal from guessed contact radii (n,) [mm]; follow the path only if necessary.

        The state found is on the path if exactly those open asperities came into contact that would otherwise
        penetrate the plane. A new contact under tension increases the approach by its load divided by the
        stiffness. If it might not have touched the plane without this increase, the path is followed.
        """
        before: IntArray = np.empty(0, dtype=np.int64) if self.state is None else self.state.closed
        held = np.zeros(len(guess), dtype=bool)
        held[before] = True
        entry = self.scene.entry_radius
        closed, a = np.flatnonzero(held | (guess > SURE * entry)), np.maximum(guess, entry)
        x = 0.0
        for _ in range(MOST_TRIALS if closed.size else 0):
            contacts = Contacts(self.scene, closed)
            found = solve(contacts, a[closed], x, goal.condition())
            if found is None or not goal.stable(found) or (self.state is not None and found.x < self.state.x):
                break
            apart = (found.found.indentation < 0.0) & ~held[closed]
            if not apart.any() and not found.entering.size:
                nearer = DOUBT * np.maximum(-found.p, 0.0) / found.stiffness
                if (found.found.indentation < nearer)[~held[closed]].any():
                    break
                self.state = found
                return found
            a[closed] = found.a
            x = found.x
            closed = np.sort(np.append(closed[~apart], contacts.others[found.entering]))
        return self.press(goal)

    def _unit(self, state: State, goal: Goal) -> float:
        """Return the rounding error of the load [mm^2] or the approach [mm] of a state."""
        depth = state.found.depth
        return 1e-12 * float((state.a * depth).sum() if goal.by_load else depth.max())

    def _first_touch(self) -> float:
        return float(self.scene.gap.min())

    def _forward(self, state: State, goal: Goal) -> State | None:
        """Return the state at the goal without new contacts, or a state on the way to it, or None."""
        if goal.stable(state):
            shift = goal.shift(state)
            change = state.rate * shift
            if shift >= 0.0 and float((change / state.a).max()) <= FORWARD:
                trial = self._from(state, shift, goal.condition())
                if trial is not None and trial.x >= state.x and goal.stable(trial):
                    return trial
        length = 0.5 / float((state.rate / state.a).max())
        if not goal.by_load:
            length = min(length, 0.5 * (goal.value - state.x))
        for _ in range(MOST_SEARCHES):
            trial = self._from(state, length, at_approach(state.x + length))
            if trial is not None and trial.holds:
                return trial
            length *= 0.5
        return None

    def _from(self, state: State, shift: float, condition: Condition) -> State | None:
        """Solve from the state that the tangent predicts for a change of the approach."""
        change = state.rate * shift
        a = np.clip(state.a + change, 0.3 * state.a, 0.5 * (state.a + state.contacts.largest_radius))
        return solve(state.contacts, a, state.x + shift, condition)

    def _blend(self, state: State, other: State, share: float, condition: Condition) -> State | None:
        """Solve from an interpolation between two states with the same contacts."""
        a = state.a + share * (other.a - state.a)
        return solve(state.contacts, a, state.x + share * (other.x - state.x), condition)

    def _enter_first(self) -> None:
        """Make the tallest asperities jump into contact."""
        first = self._first_touch()
        entering = np.flatnonzero(self.scene.gap <= first)
        self.extreme = 0.0
        nothing: IntArray = np.empty(0, dtype=np.int64)
        self.state = self._joined(nothing, np.empty(0), first, entering)
        self._land(0.0, 0.0, self.press)

    def _enter(self, state: State, trial: State, goal: Goal) -> None:
        """Make the first asperity whose gap closes between two states jump into contact."""
        touch = self._touch(state, trial)
        self.state = self._joined_at(touch)
        if touch.load >= self.extreme and goal.by_load:
            self.extreme = touch.load
            self._land(touch.load, touch.area, self.press)

    def _touch(self, state: State, trial: State) -> State:
        """Return the state at which the first gap between two states closes."""
        for _ in range(MOST_SEARCHES):
            ahead = trial.entering
            if not ahead.size:
                break
            gap = np.maximum(-state.overlap[ahead], 0.0)
            part = gap / (gap + trial.overlap[ahead])
            k, share = int(ahead[part.argmin()]), float(part.min())
            found = self._blend(state, trial, share, touching(state.contacts, k))
            if found is not None and found.holds:
                trial = found
                continue
            half = 0.5 * (trial.x - state.x)
            middle = self._from(state, half, at_approach(state.x + half))
            if middle is None:
                raise NotConverged(f"the gap of asperity {state.contacts.others[k]} cannot be followed")
            state, trial = (state, middle) if middle.entering.size else (middle, trial)
        return trial

    def _joined_at(self, touch: State) -> State:
        """Return the state at the same approach after the asperities that touch jumped into contact."""
        near = touch.overlap >= -CLOSED * float(touch.found.depth.max())
        return self._joined(touch.closed, touch.a, touch.x, touch.contacts.others[near])

    def _joined(self, closed: IntArray, a: FloatArray, x: float, entering: IntArray) -> State:
        """Return the state at an approach after asperities, and others due to them, jumped into contact."""
        while True:
            whole = np.concatenate([closed, entering])
            order = np.argsort(whole)
            start = np.concatenate([a, self.scene.entry_radius[entering]])[order]
            state = solve(Contacts(self.scene, whole[order]), start, x, at_approach(x))
            if state is None or not state.holds:
                raise NotConverged(f"no equilibrium after asperities {entering.tolist()} came into contact")
            if not state.entering.size:
                return state
            closed, a, entering = state.closed, state.a, state.contacts.others[state.entering]

    def _land(self, load: float, area: float, move: Callable[[Goal], State | None]) -> None:
        """Follow a jump at a load to its end, and record it."""
        landed = move(Goal(load, by_load=True))
        if self.record:
            self.jumps.append(Jump(load, area, 0.0 if landed is None else landed.area))
