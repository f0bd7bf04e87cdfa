"""Adhesive contacts followed while the plane approaches, and while it recedes.

At a given approach the contacts stay in equilibrium. An open asperity jumps into contact where its gap
closes; a contact breaks where its branch ends: there dF/da is singular. Under a given load the plane moves on
until the load is carried again, so that a state at a load is the first one on the way: forward where the load
first rises to it, back where it first falls to it. Both are stable under that load.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

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
    at_radius,
    solve,
    touching,
)

# Largest relative change of a contact radius that the tangent may predict for one step, forward and back.
FORWARD, BACK = 3.0, 0.4

# Relative step in the radius of the contact that shrinks fastest, and the smallest one.
STEP, LEAST_STEP = 0.2, 1e-6

# The end of a branch and the lowest load are located to this part of a contact radius. There the load is
# stationary, so that its error is the square of this.
LOCATED = 1e-7
COARSE = 1e-3

# Most sets of contacts that are tried from a guess, and the contact radius over that after a jump into
# contact above which an asperity without interaction is in contact with interaction, too.
MOST_TRIALS, SURE = 8, 1.5

# Factor of the estimate of how much nearer a new contact brings the plane.
DOUBT = 2.0

# Most steps between two loads, and in the search for one point.
MOST_STEPS = 1000
MOST_SEARCHES = 60


class Goal(NamedTuple):
    """A load [mm^2] or an approach [mm] at which a state is wanted."""

    value: float
    by_load: bool

    def condition(self) -> Condition:
        """Return the condition of Newton's method."""
        return at_load(self.value) if self.by_load else at_approach(self.value)

    def measure(self, state: State) -> float:
        """Return the load or the approach of a state."""
        return state.load if self.by_load else state.x

    def stable(self, state: State) -> bool:
        """Whether the contacts are stable under this control."""
        return state.stable if self.by_load else state.holds

    def shift(self, state: State) -> float:
        """Return the change of the approach that the tangent predicts [mm]."""
        missing = self.value - self.measure(state)
        return missing / state.stiffness if self.by_load else missing


@dataclass
class Continuation:
    """The path of one surface; `state` is None while nothing is in contact."""

    scene: Scene
    record: bool = True  # whether jumps are recorded
    state: State | None = None
    jumps: list[Jump] = field(default_factory=list)
    extreme: float = -np.inf  # load up to which the way is known: the largest forward, the lowest back

    def press(self, goal: Goal) -> State | None:
        """Move forward to a goal; return the state, or None if nothing is in contact there."""
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
        """As `press`, from a guess of the contact radii (n,) [mm] at the goal, without the jumps on the way.

        A state with every asperity in contact that would penetrate the plane, and no new one that would not,
        is that at the end of the way. A new contact under tension moves the plane nearer by its load over
        the stiffness; if it might not touch without that, the way is followed.
        """
        before: IntArray = np.empty(0, dtype=np.int64) if self.state is None else self.state.closed
        held = np.zeros(len(guess), dtype=bool)
        held[before] = True
        entry = self.scene.entry_radius
        closed, a = np.flatnonzero(held | (guess > SURE * entry)), np.maximum(guess, entry)
        x = 0.0
        for _ in range(MOST_TRIALS if closed.size else 0):
            contacts, law = Contacts(self.scene, closed), self.scene.law
            p = law.load(a[closed], contacts.radius)
            found = solve(contacts, a[closed], p, x, goal.condition())
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

    def turn(self) -> None:
        """Begin the way back."""
        self.jumps, self.extreme = [], np.inf

    def withdraw(self, goal: Goal) -> State | None:
        """Move back to a goal; return the state, or None if all contacts broke before."""
        for _ in range(MOST_STEPS):
            state = self.state
            if state is None:
                return None
            if goal.measure(state) <= goal.value + self._unit(state, goal) and goal.stable(state):
                return state
            near = self._directly(state, goal)
            if near is not None:
                self.state = near
                return near
            self._shrink(state, goal)
        raise NotConverged("the adhesive contacts do not settle")

    def _unit(self, state: State, goal: Goal) -> float:
        """Return what is rounding in a load or an approach."""
        depth = state.found.depth
        return 1e-12 * float((state.a * depth).sum() if goal.by_load else depth.max())

    def _first_touch(self) -> float:
        return float(self.scene.gap.min())

    # Forward

    def _forward(self, state: State, goal: Goal) -> State | None:
        """Return the state at the goal without new contacts, or one on the way to it."""
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
        """Solve from the prediction of the tangent at a shift of the approach."""
        change = state.rate * shift
        moved = state.linear.along(change)
        a = np.clip(state.a + change, 0.3 * state.a, 0.5 * (state.a + state.contacts.largest_radius))
        return solve(state.contacts, a, state.p + moved, state.x + shift, condition)

    def _blend(self, state: State, other: State, share: float, condition: Condition) -> State | None:
        """Solve from a state between two of the same contacts."""
        a, p = state.a + share * (other.a - state.a), state.p + share * (other.p - state.p)
        return solve(state.contacts, a, p, state.x + share * (other.x - state.x), condition)

    def _enter_first(self) -> None:
        """Let the tallest asperities jump into contact."""
        first = self._first_touch()
        entering = np.flatnonzero(self.scene.gap <= first)
        self.extreme = 0.0
        nothing: IntArray = np.empty(0, dtype=np.int64)
        self.state = self._joined(nothing, np.empty(0), np.empty(0), first, entering)
        self._land(0.0, 0.0, self.press)

    def _enter(self, state: State, trial: State, goal: Goal) -> None:
        """Let the first asperity whose gap closes between two states jump into contact."""
        touch = self._touch(state, trial)
        self.state = self._joined_at(touch)
        if touch.load >= self.extreme and goal.by_load:
            self.extreme = touch.load
            self._land(touch.load, touch.area, self.press)

    def _enter_back(self, state: State, trial: State, goal: Goal) -> None:
        """As `_enter` on the way back: there the plane comes nearer until the load is carried again."""
        touch = self._touch(state, trial)
        self.state = self._joined_at(touch)
        if goal.by_load:
            lowest, self.extreme = self.extreme, np.inf
            self._land(touch.load, touch.area, self.press)
            self.extreme = lowest

    def _touch(self, state: State, trial: State) -> State:
        """Locate the first gap that closes between two states."""
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
        """Return the state with the asperities that touch the plane in contact, at the same approach."""
        near = touch.overlap >= -CLOSED * float(touch.found.depth.max())
        return self._joined(touch.closed, touch.a, touch.p, touch.x, touch.contacts.others[near])

    def _with(
        self, closed: IntArray, a: FloatArray, p: FloatArray, others: IntArray
    ) -> tuple[Contacts, FloatArray, FloatArray]:
        """Return contacts, radii and loads with others that jump into contact."""
        radius = self.scene.entry_radius_at(others, closed, p)
        whole = np.concatenate([closed, others])
        order = np.argsort(whole)
        load = self.scene.law.load(radius, self.scene.radius[others])
        contacts = Contacts(self.scene, whole[order])
        return contacts, np.concatenate([a, radius])[order], np.concatenate([p, load])[order]

    def _joined(self, closed: IntArray, a: FloatArray, p: FloatArray, x: float, entering: IntArray) -> State:
        """Solve at an approach with asperities that jump into contact, and with those that follow them."""
        while True:
            start = self._with(closed, a, p, entering)
            state = solve(*start, x, at_approach(x))
            if state is None or not state.holds:
                raise NotConverged(f"no equilibrium after asperities {entering.tolist()} came into contact")
            if not state.entering.size:
                return state
            closed, a, p, entering = state.closed, state.a, state.p, state.contacts.others[state.entering]

    def _land(self, load: float, area: float, move: Callable[[Goal], State | None]) -> None:
        """Follow a jump at a load up to its end, and record it."""
        landed = move(Goal(load, by_load=True))
        if self.record:
            self.jumps.append(Jump(load, area, 0.0 if landed is None else landed.area))

    # Back

    def _directly(self, state: State, goal: Goal) -> State | None:
        """Return the state at the goal if it is near and no contact comes or goes before."""
        if not goal.stable(state):
            return None
        shift = goal.shift(state)
        if float(np.abs(state.rate * shift / state.a).max()) > BACK:
            return None
        trial = self._from(state, shift, goal.condition())
        rounding = CLOSED * float(state.found.depth.max())
        if trial is None or not goal.stable(trial) or trial.x > state.x + rounding or trial.entering.size:
            return None
        if float(np.abs(trial.a / state.a - 1.0).max()) > 1.5 * BACK:
            return None
        return trial

    def _shrink(self, state: State, goal: Goal) -> None:
        """Let the contact that shrinks fastest shrink by a step, at most to the end of its branch."""
        i = int((state.rate / state.a).argmax())
        step = STEP
        while True:
            new = self._at_radius(state, i, state.a[i] * (1.0 - step))
            if new is not None and self._within(state, new, i):
                break
            step *= 0.5
            if step < LEAST_STEP:
                self._leave(state, goal)
                return
        if new.entering.size:
            self._enter_back(state, new, goal)
            return
        end = new
        if not new.holds:
            value = _turning(i) if state.rate[i] * new.rate[i] < 0.0 else _holding
            end = self._search(state, new, i, value, COARSE if goal.by_load else LOCATED)
            if goal.by_load and end.stiffness > 0.0:  # the load is lowest nearer to the end
                end = self._search(end, new, i, value, LOCATED)
        if goal.by_load and state.stiffness > 0.0:
            if end.stiffness <= 0.0 or not new.holds:
                rises = end.stiffness <= 0.0
                lowest = self._search(state, end, i, lambda s: s.stiffness, LOCATED) if rises else end
                if lowest.load > goal.value:
                    if lowest.load < self.extreme:
                        self.extreme = lowest.load
                        self.state = end
                        if not new.holds:
                            self._leave(end, goal)
                        self._land(lowest.load, lowest.area, self.withdraw)
                        return
                else:
                    end = lowest
            if end.load <= goal.value:
                self.state = self._between(state, end, goal)
                return
        elif not goal.by_load and end.x <= goal.value:
            self.state = self._between(state, end, goal)
            return
        self.state = end
        if not new.holds and end is not new:
            self._leave(end, goal)

    def _within(self, state: State, new: State, i: int) -> bool:
        """Whether no other contact changes much more than the one whose radius is set."""
        change = np.abs(new.a / state.a - 1.0)
        return bool(change.max() <= 2.0 * change[i])

    def _at_radius(self, state: State, i: int, radius: float) -> State | None:
        """Solve for a radius of contact i from the tangent."""
        shift = (radius - state.a[i]) / state.rate[i]
        change = state.rate * shift
        a, p = np.maximum(state.a + change, 0.3 * state.a), state.p + state.linear.along(change)
        return solve(state.contacts, a, p, state.x + shift, at_radius(state.contacts, i, radius))

    def _search(
        self, state: State, new: State, i: int, value: Callable[[State], float], part: float
    ) -> State:
        """Return the last state before a value changes its sign, to a part of the radius of contact i."""
        width = state.a[i] - new.a[i]

        def at(radius: float) -> State:
            share = (state.a[i] - radius) / width
            found = self._blend(state, new, share, at_radius(state.contacts, i, radius))
            if found is None:
                raise NotConverged("the adhesive contacts cannot be followed to the end of a branch")
            return found

        near = part * float(state.a[i])
        ends = float(new.a[i]), float(state.a[i])
        if (value(at(ends[0])) > 0.0) == (value(at(ends[1])) > 0.0):
            return state
        root = brentq(lambda radius: value(at(radius)), *ends, xtol=near, maxiter=MOST_SEARCHES)
        before = root + 2.0 * near
        return state if before >= state.a[i] else at(before)

    def _between(self, state: State, end: State, goal: Goal) -> State:
        """Return the state at a goal between two states."""
        share = (goal.measure(state) - goal.value) / (goal.measure(state) - goal.measure(end))
        found = self._blend(state, end, share, goal.condition())
        if found is None:
            raise NotConverged("the adhesive contacts cannot be followed to the end of a branch")
        return found

    def _leave(self, state: State, goal: Goal) -> None:
        """Break the contact that shrinks fastest, and those that break with it, at the same approach."""
        rate = np.abs(state.rate / state.a)
        closed, a, p = state.closed, state.a, state.p
        while len(closed):
            kept = np.arange(len(closed)) != rate.argmax()
            closed, a, p, rate = closed[kept], a[kept], p[kept], rate[kept]
            if not len(closed):
                break
            contacts = Contacts(self.scene, closed)
            found = solve(contacts, a, p, state.x, at_approach(state.x))
            if found is not None and found.holds and float(np.abs(found.a / a - 1.0).max()) < BACK:
                self.state = found
                return
        self.state = None


def _turning(i: int) -> Callable[[State], float]:
    """Return the derivative of the approach by the radius of contact i: 0 at the end of a branch."""
    return lambda state: float(1.0 / state.rate[i])


def _holding(state: State) -> float:
    """Return a value whose sign says whether the contacts are stable at a given approach."""
    return 1.0 if state.holds else -1.0
