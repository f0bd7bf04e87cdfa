"""Equations of adhesive contacts, and Newton's method for many states at once; loads are P/E* [mm^2].

The unknowns are the contact radii a_i of the closed contacts and the approach x, under one condition such as
a given total load. The other contacts act as point loads:

    F_i = d(a_i) + sum_j K_ij P(a_j) - (x - gap_i) = 0.

Asperities that do not interact are the case K = 0. With the depth d_cap of the cap, c = d d_cap/da and
s = sqrt(2 pi w a/E*), JKR's law has d = d_cap - s, ``d' = c - s/(2 a)`` and ``P' = 2 a c - 3 s``.

A contact is a sum of flat punches, so that at given radii the loads are linear in x, with the compliance
``Q = diag(1/(2 a)) + K``. The energy at given x, minimised over the loads, is a function of the radii alone.
Its second derivatives are ``diag(2 s/a) [diag(a P'/s) + Q^-1] diag(2 s/a)`` divided by 4. The contacts are
stable at fixed approach if this matrix is positive definite, and stable at fixed load if the load increases
with the approach as well. A branch ends where this matrix, and therefore dF/da, is singular.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dpotrf

from metafem._validate import FloatArray, IntArray
from metafem.contact import JKR
from metafem.contact.jkr import of_sizes
from metafem.contact.law import sizes_of

BoolArray = np.ndarray

# Largest residual of a converged state, and that at which Newton's method stops: above rounding.
TOLERANCE, GOAL = 1e-12, 2e-13

# A double root at the end of a branch halves the error in each step, so that 60 steps reach rounding.
MOST_STEPS = 60

EVERY = slice(None)

# Shortest step that the line search takes, over a step of Newton's method.
SHORTEST = 1e-3


@dataclass(frozen=True)
class Condition:
    """``by_load . P + by_radius . a + by_approach x = value``, for k states of n contacts."""

    value: FloatArray  # (k,)
    by_load: FloatArray | None = None  # (k, n)
    by_radius: FloatArray | None = None  # (k, n)
    by_approach: float = 0.0

    def part(self, rows: IntArray | slice, columns: IntArray | slice = EVERY) -> Condition:
        """Return the condition of some states and contacts."""
        weights = (
            None if each is None else each[rows][:, columns] for each in (self.by_load, self.by_radius)
        )
        return Condition(self.value[rows], *weights, self.by_approach)


def at_load(load: FloatArray, count: int) -> Condition:
    """Return the condition of total loads (k,) [mm^2] of `count` asperities."""
    return Condition(load, by_load=np.ones((len(load), count)))


def at_approach(approach: FloatArray) -> Condition:
    """Return the condition of approaches (k,) [mm]."""
    return Condition(approach, by_approach=1.0)


def at_radius(index: IntArray, radius: FloatArray, count: int) -> Condition:
    """Return the condition of the radii (k,) [mm] of one contact in each state, of `count` asperities."""
    return Condition(radius, by_radius=np.eye(count)[index])


class Fields(NamedTuple):
    """The law at contact radii, arrays (k, n)."""

    load: FloatArray  # P [mm^2]; 0 for open contacts
    depth: FloatArray  # d_cap [mm]; for open contacts that after a jump into contact
    deficit: FloatArray  # s [mm]; also
    rise: FloatArray  # dP/da [mm]; 0 for open contacts
    slope: FloatArray  # dd/da [-]; 1 for open contacts


@dataclass(frozen=True)
class Scene:
    """Adhesive asperities (n,) and their influence on each other, (n, n)."""

    law: JKR  # for a material
    radius: FloatArray
    gap: FloatArray
    influence: FloatArray | None = None  # K, with the terms of the asperities themselves on its diagonal

    @cached_property
    def entry_radius(self) -> FloatArray:
        """Contact radius (n,) [mm] after the jump into contact, at d = 0."""
        return of_sizes(JKR.entry_radius, self.law, self.radius)

    @cached_property
    def break_radius(self) -> FloatArray:
        """Contact radius (n,) [mm] at the end of the branch of a contact without neighbours."""
        return of_sizes(JKR.break_radius, self.law, self.radius)

    @cached_property
    def largest_radius(self) -> FloatArray:
        """Largest contact radius (n,) [mm] that the cap describes."""
        cap = self.law.cap
        most = np.minimum(cap.largest_indentation(self.radius), 1e3 * sizes_of(self.radius))
        return np.asarray(cap.contact_radius(most, self.radius))

    def part(self, columns: IntArray) -> Scene:
        """Return some of the asperities."""
        inner = None if self.influence is None else self.influence[np.ix_(columns, columns)]
        found = Scene(self.law, self.radius[columns], self.gap[columns], inner)
        for name in ("entry_radius", "break_radius", "largest_radius"):
            found.__dict__[name] = getattr(self, name)[columns]
        return found

    def fields(self, a: FloatArray, closed: BoolArray) -> Fields:
        """Return the law at contact radii (k, n) [mm]."""
        law, cap = self.law, self.law.cap
        whole = closed.all()
        a = a if whole else np.where(closed, a, self.entry_radius)
        depth, s, c = cap.indentation(a, self.radius), law.deficit(a), cap.profile_slope(a, self.radius)
        load, rise = cap.load(a, self.radius) - 2.0 * a * s, 2.0 * a * c - 3.0 * s
        slope = c - 0.5 * s / a
        if not whole:
            load, rise, slope = load * closed, rise * closed, np.where(closed, slope, 1.0)
        return Fields(load, depth, s, rise, slope)

    def displacement(self, load: FloatArray) -> FloatArray | float:
        """Return the displacements (k, n) [mm] by loads (k, n)."""
        return 0.0 if self.influence is None else load @ self.influence.T

    def solved(self, fields: Fields, right: FloatArray, transposed: bool = False) -> FloatArray:
        """Return J^-1 b, (k, n, q), with ``J = dF/da`` at the given fields."""
        if self.influence is None:
            return np.asarray(right / np.where(fields.slope == 0.0, TOLERANCE, fields.slope)[:, :, None])
        matrix = self.influence * fields.rise[:, None, :]
        diagonal = np.arange(len(self.gap))
        matrix[:, diagonal, diagonal] += fields.slope
        try:
            return np.linalg.solve(matrix.swapaxes(1, 2) if transposed else matrix, right)
        except np.linalg.LinAlgError:
            return np.full_like(right, np.nan)

    def solve(
        self, closed: BoolArray, a: FloatArray, x: FloatArray, condition: Condition, goal: float = GOAL
    ) -> States:
        """Return k states by Newton's method with a line search; see `States.converged`.

        closed: which asperities are in contact, (k, n). a (k, n), x (k,): initial guess [mm]. goal: residual
        at which the method stops.
        """
        kept, some, inner = closed, self, condition
        columns = np.flatnonzero(closed.any(axis=0))
        whole = len(columns) == len(self.gap)
        if not whole:
            kept, a, some, inner = (
                closed[:, columns],
                a[:, columns],
                self.part(columns),
                condition.part(EVERY, columns),
            )
        a, x = some._newton(kept, np.where(kept, a, some.entry_radius), x, inner, goal)
        found = a * kept
        if not whole:
            found = np.zeros(closed.shape)
            found[:, columns] = a * kept
        return States(self, closed, found, x, condition)

    def _newton(
        self, closed: BoolArray, a: FloatArray, x: FloatArray, condition: Condition, goal: float
    ) -> tuple[FloatArray, FloatArray]:
        """Return the contact radii and approaches of `solve`.

        The residual decreases in each step; a step that increases it is halved.
        """
        least, largest = 0.5 * self.break_radius, self.largest_radius
        best_a, best_x, error = a.copy(), x.copy(), np.full(len(x), np.inf)
        step, shift, length, unit = np.zeros_like(a), np.zeros_like(x), np.ones_like(x), np.zeros((2, len(x)))
        rows = np.arange(len(x))
        for _ in range(MOST_STEPS):
            fields = self.fields(a, closed)
            force, wrong, own = self.errors(fields, closed, a, x, condition)
            larger = np.maximum(own, unit[:, rows])
            merit = np.maximum(np.abs(force).max(axis=1) / larger[0], np.abs(wrong) / larger[1])
            better = merit < error[rows]
            good = rows[better]
            best_a[good], best_x[good], error[good], unit[:, good] = (
                a[better],
                x[better],
                merit[better],
                own[:, better],
            )
            length[rows[~better]] *= 0.5
            # below the tolerance, shorter steps do not help against rounding errors
            going = np.where(better, merit > goal, (error[rows] > TOLERANCE) & (length[rows] >= SHORTEST))
            if not going.any():
                break
            if better.any():
                change, move = self._step(fields, force, wrong, condition)
                # a contact radius at most doubles, and at least is halved, in one step
                relative = change / a
                most = np.maximum(relative.max(axis=1), -2.0 * relative.min(axis=1))
                step[good], shift[good] = change[better], move[better]
                length[good] = 1.0 / np.maximum(most[better], 1.0)
            if not going.all():
                rows, closed, condition = rows[going], closed[going], condition.part(going)
            a, x = best_a[rows] + length[rows, None] * step[rows], best_x[rows] + length[rows] * shift[rows]
            a = np.maximum(np.minimum(a, 0.5 * (best_a[rows] + largest)), least)
        return best_a, best_x

    def errors(
        self, fields: Fields, closed: BoolArray, a: FloatArray, x: FloatArray, condition: Condition
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return F (k, n), the error of the condition (k,), and the units of both (2, k)."""
        force = fields.depth - fields.deficit + self.displacement(fields.load) - (x[:, None] - self.gap)
        deepest = fields.depth.max(axis=1)
        wrong, unit = condition.by_approach * x - condition.value, condition.by_approach * deepest
        if condition.by_load is not None:
            wrong += (condition.by_load * fields.load).sum(axis=1)
            unit += (np.abs(condition.by_load) * a * fields.depth).sum(axis=1)
        if condition.by_radius is not None:
            wrong += (condition.by_radius * a).sum(axis=1)
            unit += condition.value
        return force * closed, wrong, np.array([deepest, unit])

    def _step(
        self, fields: Fields, force: FloatArray, wrong: FloatArray, condition: Condition
    ) -> tuple[FloatArray, FloatArray]:
        """Return Newton's steps in the radii (k, n) and in the approaches (k,)."""
        right = np.empty((*force.shape, 2))
        right[:, :, 0], right[:, :, 1] = -force, 1.0
        change, rate = np.moveaxis(self.solved(fields, right), 2, 0)
        top, below = -wrong, np.full(len(wrong), condition.by_approach)
        for weight, scale in ((condition.by_load, fields.rise), (condition.by_radius, 1.0)):
            if weight is not None:
                top -= (weight * scale * change).sum(axis=1)
                below += (weight * scale * rate).sum(axis=1)
        shift = top / below
        return change + rate * shift[:, None], shift


@dataclass(frozen=True, eq=False)
class States:
    """k states of n asperities at approaches x (k,) [mm]; a is 0 for open ones."""

    scene: Scene
    closed: BoolArray  # (k, n)
    a: FloatArray  # contact radii (k, n) [mm]
    x: FloatArray
    condition: Condition

    def __getitem__(self, rows: IntArray) -> States:
        """Return some of the states."""
        return States(self.scene, self.closed[rows], self.a[rows], self.x[rows], self.condition.part(rows))

    def moved(self, a: FloatArray, x: FloatArray, condition: Condition, goal: float = GOAL) -> States:
        """Return the states of the same contacts under a condition, from guesses of a and x."""
        return self.scene.solve(self.closed, a, x, condition, goal)

    def blended(self, other: States, share: FloatArray, condition: Condition) -> States:
        """Return the states under a condition, guessed between these and others with the same contacts."""
        a = self.a + share[:, None] * (other.a - self.a)
        return other.moved(a, self.x + share * (other.x - self.x), condition)

    def where(self, chosen: BoolArray, other: States) -> States:
        """Return these states where chosen (k,), and elsewhere others with the same contacts."""
        a, x = np.where(chosen[:, None], self.a, other.a), np.where(chosen, self.x, other.x)
        return States(self.scene, other.closed, a, x, at_approach(x))

    @cached_property
    def fields(self) -> Fields:
        """The law at the contact radii."""
        return self.scene.fields(self.a, self.closed)

    @property
    def load(self) -> FloatArray:
        """Total loads (k,) [mm^2]."""
        return np.asarray(self.fields.load.sum(axis=1))

    @property
    def area(self) -> FloatArray:
        """Real contact areas (k,) [mm^2]."""
        return np.asarray(np.pi * (self.a**2).sum(axis=1))

    @cached_property
    def rate(self) -> FloatArray:
        """Derivatives of the contact radii with respect to the approach, (k, n) [-]."""
        return self.scene.solved(self.fields, np.ones((*self.a.shape, 1)))[:, :, 0] * self.closed

    @cached_property
    def stiffness(self) -> FloatArray:
        """Derivatives of the loads with respect to the approach, (k,) [mm]."""
        return np.asarray((self.fields.rise * self.rate).sum(axis=1))

    @cached_property
    def overlap(self) -> FloatArray:
        """Overlaps of the open asperities with the plane (k, n) [mm], minus the gap; -inf for closed ones."""
        free = self.x[:, None] - self.scene.gap - self.scene.displacement(self.fields.load)
        return np.where(self.closed, -np.inf, free)

    @cached_property
    def indentation(self) -> FloatArray:
        """Indentations (k, n) [mm]; minus the gap of an open asperity."""
        return np.where(self.closed, self.fields.depth - self.fields.deficit, self.overlap)

    @cached_property
    def residual(self) -> FloatArray:
        """Largest relative error of the equations and of the condition, (k,).

        Errors of F are divided by the largest depth of a cap, those of a load by the larger of this load and
        the sum of the loads 2 a s, by which adhesion lowers those of the caps.
        """
        given = self.closed, self.a, self.x, self.condition
        force, wrong, unit = self.scene.errors(self.fields, *given)
        if self.condition.by_load is not None:
            unit[1] = np.maximum(
                (2.0 * self.a * self.fields.deficit).sum(axis=1), np.abs(self.condition.value)
            )
        unit = np.where(unit > 0.0, unit, 1.0)
        return np.maximum(np.abs(force).max(axis=1) / unit[0], np.abs(wrong) / unit[1])

    @property
    def converged(self) -> BoolArray:
        """Whether Newton's method converged, (k,)."""
        return self.residual <= TOLERANCE

    @cached_property
    def holds(self) -> BoolArray:
        """Whether the contacts are stable at fixed approach, (k,)."""
        if self.scene.influence is None:
            return np.asarray((self.fields.slope > 0.0).all(axis=1))
        stable = np.ones(len(self.x), dtype=bool)
        for row in np.flatnonzero((self.fields.rise < 0.0).any(axis=1)):
            kept = np.flatnonzero(self.closed[row])
            a, s, rise = self.a[row, kept], self.fields.deficit[row, kept], self.fields.rise[row, kept]
            inner = self.scene.influence[np.ix_(kept, kept)]
            matrix = np.linalg.inv(0.5 * (inner + inner.T) + np.diag(0.5 / a)) + np.diag(a * rise / s)
            stable[row] = dpotrf(matrix)[1] == 0
        return stable

    def gradient(self) -> FloatArray:
        """Return dA0/dh at fixed load [mm], (k, n)."""
        both = np.stack([2.0 * np.pi * self.a, self.fields.rise], axis=2)
        by_area, by_load = np.moveaxis(self.scene.solved(self.fields, both, transposed=True), 2, 0)
        total = by_load.sum(axis=1, keepdims=True)
        share = by_load / np.where(total > 0.0, total, 1.0)
        return np.asarray(by_area - by_area.sum(axis=1, keepdims=True) * share)


def joined(parts: list[States]) -> States:
    """Return the states of several parts, with the approach as the condition."""
    closed, a, x = (np.concatenate([getattr(part, name) for part in parts]) for name in ("closed", "a", "x"))
    return States(parts[0].scene, closed, a, x, at_approach(x))
