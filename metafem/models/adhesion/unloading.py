"""Unloading path of adhesive contacts that interact.

As on loading, the path consists of stable equilibria at fixed approach. A contact breaks at the end of its
branch, where dF/da is singular. The state at a load is the first point of the path with this load.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from metafem.errors import NotConverged
from metafem.models.adhesion.loading import MOST_SEARCHES, MOST_STEPS, Goal, Loading
from metafem.models.adhesion.scene import Contacts
from metafem.models.adhesion.solve import CLOSED, State, at_approach, at_radius, solve

# Largest relative change of a contact radius in one step, as predicted by the tangent.
BACK = 0.4

# Relative step in the radius of the contact that shrinks fastest, and the smallest such step.
STEP, LEAST_STEP = 0.2, 1e-6

# Tolerances, relative to a contact radius, for the end of a branch and the lowest load. The load is
# stationary at both, so its error is the square of the tolerance. COARSE is used at first under load control.
LOCATED = 1e-7
COARSE = 1e-3


class _Unconnected(Exception):
    """No branch connects two states."""


class Unloading(Loading):
    """The unloading path of one surface, from its state under the largest load."""

    def withdraw(self, goal: Goal) -> State | None:
        """Follow the path back to a goal; return the state, or None if all contacts break before the goal."""
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

    def _enter_back(self, state: State, trial: State, goal: Goal) -> None:
        """Make an asperity jump into contact on unloading; the plane then advances to restore the load."""
        touch = self._touch(state, trial)
        self.state = self._joined_at(touch)
        if goal.by_load:
            lowest, self.extreme = self.extreme, np.inf
            self._land(touch.load, touch.area, self.press)
            self.extreme = lowest

    def _directly(self, state: State, goal: Goal) -> State | None:
        """Return the state at the goal if it is near and no contact forms or breaks before it, else None."""
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
        """Reduce the radius of the contact that shrinks fastest, at most to the end of its branch."""
        i = int((state.rate / state.a).argmax())
        step = STEP
        while True:
            new = self._at_radius(state, i, state.a[i] * (1.0 - step))
            if new is not None and self._within(state, new, i):
                end = new if new.holds or new.entering.size else self._end(state, new, i, goal)
                if end is not None:
                    break
            step *= 0.5
            if step < LEAST_STEP:
                self._leave(state, goal)
                return
        if new.entering.size:
            self._enter_back(state, new, goal)
            return
        if goal.by_load and state.stiffness > 0.0:
            if end.stiffness <= 0.0 or not new.holds:
                rises = end.stiffness <= 0.0
                lowest = self._search(state, end, i, lambda s: s.stiffness, LOCATED) if rises else end
                if lowest is None:
                    raise NotConverged("the adhesive contacts cannot be followed to the lowest load")
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

    def _end(self, state: State, new: State, i: int, goal: Goal) -> State | None:
        """Return the end of the branch before `new`, which is unstable; None if no branch connects them.

        If two contacts near the ends of their branches shrink together, the contact that shrinks fastest may
        change between the states. `new` then lies on a branch that the path does not reach: on the path, the
        radius of contact i grows again.
        """
        value = _turning(i) if state.rate[i] * new.rate[i] < 0.0 else _holding
        end = self._search(state, new, i, value, COARSE if goal.by_load else LOCATED)
        if end is not None and goal.by_load and end.stiffness > 0.0:  # the lowest load is closer to the end
            end = self._search(end, new, i, value, LOCATED)
        return end

    def _within(self, state: State, new: State, i: int) -> bool:
        """Return whether no contact radius changes by more than twice the relative change of contact i."""
        change = np.abs(new.a / state.a - 1.0)
        return bool(change.max() <= 2.0 * change[i])

    def _at_radius(self, state: State, i: int, radius: float) -> State | None:
        """Solve for a state with a given radius of contact i, from the prediction of the tangent."""
        shift = (radius - state.a[i]) / state.rate[i]
        change = state.rate * shift
        a = np.maximum(state.a + change, 0.3 * state.a)
        return solve(state.contacts, a, state.x + shift, at_radius(state.contacts, i, radius))

    def _search(
        self, state: State, new: State, i: int, value: Callable[[State], float], part: float
    ) -> State | None:
        """Return the last state before `value` changes sign, or None if the states are not connected.

        part: tolerance over the radius of contact i.
        """
        width = state.a[i] - new.a[i]

        def at(radius: float) -> State:
            share = (state.a[i] - radius) / width
            found = self._blend(state, new, share, at_radius(state.contacts, i, radius))
            for start in (state, new) if share < 0.5 else (new, state):
                # if the states are far apart, begin at the nearer one, then at the other
                found = found or self._at_radius(start, i, radius)
            if found is None:
                raise _Unconnected
            return found

        near = part * float(state.a[i])
        ends = float(new.a[i]), float(state.a[i])
        try:
            if (value(at(ends[0])) > 0.0) == (value(at(ends[1])) > 0.0):
                return state
            root = brentq(lambda radius: value(at(radius)), *ends, xtol=near, maxiter=MOST_SEARCHES)
            before = root + 2.0 * near
            return state if before >= state.a[i] else at(before)
        except _Unconnected:
            return None

    def _between(self, state: State, end: State, goal: Goal) -> State:
        """Return the state at a goal that lies between two states."""
        share = (goal.measure(state) - goal.value) / (goal.measure(state) - goal.measure(end))
        found = self._blend(state, end, share, goal.condition())
        if found is None:
            raise NotConverged("the adhesive contacts cannot be followed to the end of a branch")
        return found

    def _leave(self, state: State, goal: Goal) -> None:
        """Break the contact that shrinks fastest, and all that break with it, at the same approach."""
        rate = np.abs(state.rate / state.a)
        closed, a = state.closed, state.a
        while len(closed):
            kept = np.arange(len(closed)) != rate.argmax()
            closed, a, rate = closed[kept], a[kept], rate[kept]
            if not len(closed):
                break
            contacts = Contacts(self.scene, closed)
            found = solve(contacts, a, state.x, at_approach(state.x))
            if found is not None and found.holds and float(np.abs(found.a / a - 1.0).max()) < BACK:
                self.state = found
                return
        self.state = None


def _turning(i: int) -> Callable[[State], float]:
    """Return a function of a state: dx/da of contact i, which is 0 at the end of its branch."""
    return lambda state: float(1.0 / state.rate[i])


def _holding(state: State) -> float:
    """Return 1 if the contacts are stable at fixed approach, and -1 otherwise."""
    return 1.0 if state.holds else -1.0
