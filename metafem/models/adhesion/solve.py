"""Newton's method for adhesive contacts under one condition, such as a load or an approach."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs

from metafem._validate import FloatArray, IntArray
from metafem.models.adhesion.scene import Contacts, Fields, Linear

# Largest residual of a converged state, and residual at which Newton's method stops; it is smaller to allow
# for rounding.
TOLERANCE = 1e-12
GOAL = 2e-13

# Maximum number of Newton steps. A matrix is reused while each step multiplies the residual by less than
# PROGRESS. At most MOST_WORSE steps with a new matrix may increase the residual.
MOST_STEPS = 40
PROGRESS = 0.02
MOST_WORSE = 2

# Function that returns the changes of radii and approach for errors of F and of the condition.
Step = Callable[[FloatArray, float], tuple[FloatArray, float]]

# Gaps smaller than this multiple of the largest indentation of a cap are attributed to rounding.
CLOSED = 1e-11

# Largest relative change of a contact radius in one step.
LONGEST = 0.5


@dataclass(frozen=True, eq=False)
class State:
    """Contacts in equilibrium; arrays (m,) over the asperities in contact."""

    contacts: Contacts
    a: FloatArray  # contact radii [mm]
    x: float  # approach [mm]
    found: Fields
    residual: float

    @property
    def closed(self) -> IntArray:
        """Indices of the asperities in contact."""
        return self.contacts.closed

    @property
    def p(self) -> FloatArray:
        """Loads P/E* [mm^2]."""
        return self.found.load

    @property
    def load(self) -> float:
        """Total load [mm^2]."""
        return float(self.p.sum())

    @property
    def area(self) -> float:
        """Real contact area [mm^2]."""
        return float(np.pi * (self.a**2).sum())

    @cached_property
    def linear(self) -> Linear:
        """Derivatives of the equations."""
        return self.contacts.linearise(self.a)

    @cached_property
    def factors(self) -> tuple[FloatArray, IntArray]:
        """LU factors of dF/da."""
        factor, pivot, _ = dgetrf(self.linear.by_radius)
        return factor, pivot

    @cached_property
    def holds(self) -> bool:
        """Whether the contacts are stable at fixed approach.

        If they are, the determinant of dF/da is positive; it changes sign at the end of a branch. Where two
        branches end together, the sign may remain the same, but two directions become unstable.
        """
        factor, pivot = self.factors
        swaps = np.count_nonzero(pivot != np.arange(len(pivot)))
        positive = ((np.diagonal(factor) < 0.0).sum() + swaps) % 2 == 0
        return bool(positive and self.linear.excess < 2)

    @cached_property
    def rate(self) -> FloatArray:
        """Derivative of the contact radii with respect to the approach, (m,) [-]."""
        return np.asarray(dgetrs(*self.factors, np.ones(len(self.a)))[0])

    @cached_property
    def stiffness(self) -> float:
        """Derivative of the load with respect to the approach [mm]."""
        return float(self.linear.load @ self.rate)

    @property
    def stable(self) -> bool:
        """Whether the contacts are stable at fixed load."""
        return self.holds and self.stiffness > 0.0

    def area_gradient(self) -> FloatArray:
        """Return dA0/dh for the heights of the contacts at fixed load [mm], (m,)."""
        both = np.column_stack([2.0 * np.pi * self.a, self.linear.load])
        by_area, by_load = dgetrs(*self.factors, both, trans=1)[0].T
        return np.asarray(by_area - by_area.sum() / by_load.sum() * by_load)

    @cached_property
    def overlap(self) -> FloatArray:
        """Overlap of the open asperities with the plane [mm]; minus the gap if there is one."""
        return self.contacts.overlap(self.p, self.x)

    @property
    def entering(self) -> IntArray:
        """Positions in `contacts.others` of the open asperities that overlap the plane beyond rounding."""
        return np.flatnonzero(self.overlap > CLOSED * float(self.found.depth.max()))


@dataclass(frozen=True)
class Condition:
    """A condition on the contacts: its error, and the derivatives by loads, contact radii and approach."""

    error: Callable[[FloatArray, FloatArray, float], float]
    by_loads: FloatArray | float = 0.0
    by_radii: FloatArray | float = 0.0
    by_approach: float = 0.0
    of_loads: bool = False  # whether the error is a load [mm^2] instead of a length [mm]


def at_load(load: float) -> Condition:
    """Return the condition that the total load is `load` [mm^2]."""
    return Condition(lambda a, p, x: float(p.sum()) - load, by_loads=1.0, of_loads=True)


def at_approach(approach: float) -> Condition:
    """Return the condition that the approach is `approach` [mm]."""
    return Condition(lambda a, p, x: x - approach, by_approach=1.0)


def at_radius(contacts: Contacts, i: int, radius: float) -> Condition:
    """Return the condition that the contact radius of the i-th contact is `radius` [mm]."""
    unit = np.zeros(len(contacts.closed))
    unit[i] = 1.0
    return Condition(lambda a, p, x: float(a[i]) - radius, by_radii=unit)


def touching(contacts: Contacts, k: int) -> Condition:
    """Return the condition that the k-th open asperity touches the plane."""

    def error(a: FloatArray, p: FloatArray, x: float) -> float:
        return float(contacts.overlap(p, x)[k])

    return Condition(error, by_loads=-contacts.outward[:, k], by_approach=1.0)


def solve(contacts: Contacts, a: FloatArray, x: float, condition: Condition) -> State | None:
    """Return the state that satisfies the condition, or None if Newton's method does not converge.

    a, x: initial guess of contact radii [mm] and approach [mm].
    """
    step: Step | None = None
    last, worse, fresh = np.inf, 0, False
    for _ in range(MOST_STEPS):
        found = contacts.respond(a)
        force = found.indentation + found.displacement - (x - contacts.gap)
        wrong = condition.error(a, found.load, x)
        residual = _residual(a, found, force, wrong, condition)
        if not np.isfinite(residual) or (a < contacts.least_radius).any():
            return None
        if residual <= GOAL or (residual <= TOLERANCE and residual > 0.1 * last):
            return State(contacts, a, x, found, residual)
        if fresh and residual > last:
            worse += 1
            if worse > MOST_WORSE:
                return None
        fresh = step is None or residual > PROGRESS * last
        if step is None or fresh:
            step = _linear_step(contacts.linearise(a), condition)
        last = residual
        change, shift = step(force, wrong)
        if not np.isfinite(change).all():
            return None
        longest = float((np.abs(change) / a).max())
        length = LONGEST / longest if longest > LONGEST else 1.0
        if length < 1.0:
            step = None
        # the radius of a cap may be limited, as for a sphere by its equator
        a = np.minimum(a + length * change, 0.5 * (a + contacts.largest_radius))
        x += length * shift
    return None


def _residual(a: FloatArray, found: Fields, force: FloatArray, wrong: float, condition: Condition) -> float:
    """Return the largest error: lengths over the largest indentation of a cap, loads over loads of caps."""
    depth = float(found.depth.max())
    # the products are of the order of the loads of the caps
    unit = float((a * found.depth).sum()) if condition.of_loads else depth
    return float(max(np.abs(force).max() / depth, abs(wrong) / unit))


def _linear_step(linear: Linear, condition: Condition) -> Step:
    """Return a function that computes Newton steps from the errors of F and of the condition."""
    count = len(linear.by_radius)
    matrix = np.empty((count + 1, count + 1))
    matrix[:count, :count] = linear.by_radius
    matrix[:count, count] = -1.0
    matrix[count, :count] = condition.by_radii + linear.load * condition.by_loads
    matrix[count, count] = condition.by_approach
    factor, pivot, _ = dgetrf(matrix, overwrite_a=True)

    def step(force: FloatArray, wrong: float) -> tuple[FloatArray, float]:
        change = dgetrs(factor, pivot, -np.append(force, wrong))[0]
        return change[:count], float(change[count])

    return step
