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
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg.lapack import dgesv, dpotrf

from metafem._kernels.newton import TOLERANCE
from metafem._validate import FloatArray, IntArray
from metafem.contact import JKR
from metafem.contact.jkr import of_sizes
from metafem.contact.law import sizes_of

BoolArray = np.ndarray

# Residual at which Newton's method stops: above rounding.
GOAL = 2e-13


# The value (k,), and by_load (k, n), by_radius (k, n) and by_approach (k,) of the condition
# ``by_load . P + by_radius . a + by_approach x = value``, for k states of n contacts.
Condition = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


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
    influence: Any = None  # K, with the terms of the asperities themselves on its diagonal; None for 0

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

    def at_load(self, load: FloatArray) -> Condition:
        """Return the condition of total loads (k,) [mm^2]."""
        none = np.zeros((len(load), len(self.gap)))
        return load, none + 1.0, none, np.zeros(len(load))

    def at_approach(self, approach: FloatArray) -> Condition:
        """Return the condition of approaches (k,) [mm]."""
        none = np.zeros((len(approach), len(self.gap)))
        return approach, none, none, np.ones(len(approach))

    def at_radius(self, index: IntArray, radius: FloatArray) -> Condition:
        """Return the condition of the radii (k,) [mm] of one contact in each state."""
        one = (np.arange(len(self.gap)) == index[:, None]).astype(float)
        return radius, np.zeros(one.shape), one, np.zeros(len(radius))

    def fields(self, a: FloatArray, closed: BoolArray) -> Fields:
        """Return the law at contact radii (k, n) [mm]."""
        law, cap = self.law, self.law.cap
        a = np.where(closed, a, self.entry_radius)
        depth, s, c = cap.indentation(a, self.radius), law.deficit(a), cap.profile_slope(a, self.radius)
        load, rise = law.load(a, self.radius), 2.0 * a * c - 3.0 * s
        return Fields(load * closed, depth, s, rise * closed, np.where(closed, c - 0.5 * s / a, 1.0))

    def displacement(self, load: FloatArray) -> FloatArray:
        """Return the displacements (k, n) [mm] by loads (k, n)."""
        return np.zeros(load.shape) if self.influence is None else np.asarray(load @ self.influence.T)

    def solved(
        self, fields: Fields, closed: BoolArray, right: FloatArray, turned: bool = False
    ) -> FloatArray:
        """Return J^-1 b, (k, n, q), with ``J = dF/da``, or J^-T b if `turned`; 0 for open contacts."""
        if self.influence is None:
            slope = np.where(fields.slope == 0.0, TOLERANCE, fields.slope)
            return np.asarray(right * (closed / slope)[:, :, None])
        found = np.zeros(right.shape)
        for row in np.flatnonzero(closed.any(axis=1)):
            kept = np.flatnonzero(closed[row])
            # the transposed matrix by rows is the matrix by columns, which LAPACK does not copy
            matrix = self.influence.T[kept[:, None], kept] * fields.rise[row, kept, None]
            matrix.flat[:: len(kept) + 1] += fields.slope[row, kept]
            _, _, inner, failed = dgesv(matrix if turned else matrix.T, right[row, kept], overwrite_a=True)
            found[row, kept] = np.nan if failed else inner
        return found

    def solve(
        self, closed: BoolArray, a: FloatArray, x: FloatArray, condition: Condition, goal: float = GOAL
    ) -> States:
        """Return k states by Newton's method with a line search, in which the residual decreases.

        closed: which asperities are in contact, (k, n). a (k, n), x (k,): initial guess [mm]. goal: residual
        at which the method stops. Where it does not converge, the residual of the state is larger.
        """
        at = States(self, closed, np.where(closed, a, 0.0), x, condition)
        best = States(self, closed, at.a.copy(), np.array(x), condition)
        step, shift, length = np.zeros(at.a.shape), np.zeros(len(x)), np.ones(len(x))
        error, unit, rows = np.full(len(x), np.inf), np.zeros((2, len(x))), np.arange(len(x))
        for _ in range(60):  # a double root at the end of a branch halves the error in each step
            force, wrong, own = at.errors
            merit = _largest(force, wrong, np.maximum(own, unit[:, rows]))
            better = merit < error[rows]
            good = rows[better]
            best.a[good], best.x[good] = at.a[better], at.x[better]
            error[good], unit[:, good] = merit[better], own[:, better]
            length[rows[~better]] *= 0.5
            # below the tolerance, shorter steps do not help against rounding errors
            going = np.where(better, merit > goal, (error[rows] > TOLERANCE) & (length[rows] >= 1e-3))
            if not going.any():
                break
            if better.any():
                change, move = at.newton_step()
                # a contact radius at most doubles, and at least is halved, in one step
                relative = change / np.where(at.closed, at.a, 1.0)
                most = np.maximum(relative.max(axis=1), -2.0 * relative.min(axis=1))
                step[good], shift[good] = change[better], move[better]
                length[good] = 1.0 / np.maximum(most[better], 1.0)
            if not going.all():
                rows, at = rows[going], at[going]
            old, part = best.a[rows], length[rows]
            new = np.minimum(old + part[:, None] * step[rows], 0.5 * (old + self.largest_radius))
            new = np.maximum(new, 0.5 * self.break_radius) * at.closed
            at = States(self, at.closed, new, best.x[rows] + part * shift[rows], at.condition)
        return best


def _largest(force: FloatArray, wrong: FloatArray, unit: FloatArray) -> FloatArray:
    """Return the largest errors (k,) of F and of the condition over their units (2, k)."""
    return np.asarray(np.maximum(np.abs(force).max(axis=1) / unit[0], np.abs(wrong) / unit[1]))


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
        value, by_load, by_radius, by_approach = (each[rows] for each in self.condition)
        condition = value, by_load, by_radius, by_approach
        return States(self.scene, self.closed[rows], self.a[rows], self.x[rows], condition)

    def blended(self, other: States, share: FloatArray, condition: Condition) -> States:
        """Return the states under a condition, guessed between these and others with the same contacts."""
        a = self.a + share[:, None] * (other.a - self.a)
        return self.scene.solve(other.closed, a, self.x + share * (other.x - self.x), condition)

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
        return np.asarray(self.scene.solved(self.fields, self.closed, np.ones((*self.a.shape, 1)))[:, :, 0])

    @cached_property
    def stiffness(self) -> FloatArray:
        """Derivatives of the loads with respect to the approach, (k,) [mm]."""
        return np.asarray((self.fields.rise * self.rate).sum(axis=1))

    @cached_property
    def indentation(self) -> FloatArray:
        """Indentations (k, n) [mm]; minus the gap of an open asperity."""
        free = self.x[:, None] - self.scene.gap - self.scene.displacement(self.fields.load)
        return np.where(self.closed, self.fields.depth - self.fields.deficit, free)

    @cached_property
    def errors(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """F (k, n), the error of the condition (k,), and the units of both (2, k)."""
        fields, (value, by_load, by_radius, by_approach) = self.fields, self.condition
        free = self.x[:, None] - self.scene.gap - self.scene.displacement(fields.load)
        force = (fields.depth - fields.deficit - free) * self.closed
        wrong = (by_load * fields.load + by_radius * self.a).sum(axis=1) + by_approach * self.x - value
        lowered, deepest = (np.abs(by_load) * self.a * fields.deficit).sum(axis=1), fields.depth.max(axis=1)
        unit = 2.0 * lowered + by_approach * deepest + (1.0 - by_approach) * np.abs(value)
        return force, wrong, np.array([deepest, np.where(unit > 0.0, unit, 1.0)])

    def newton_step(self) -> tuple[FloatArray, FloatArray]:
        """Return Newton's steps in the radii (k, n) and in the approaches (k,)."""
        force, wrong, _ = self.errors
        both = np.stack([-force, np.ones(force.shape)], axis=2)
        found = self.scene.solved(self.fields, self.closed, both)
        change, rate = found[..., 0], found[..., 1]
        _, by_load, by_radius, by_approach = self.condition
        weight = by_load * self.fields.rise + by_radius
        shift = -(wrong + (weight * change).sum(axis=1)) / ((weight * rate).sum(axis=1) + by_approach)
        return np.asarray(change + rate * shift[:, None]), np.asarray(shift)

    @cached_property
    def residual(self) -> FloatArray:
        """Largest relative error of the equations and of the condition, (k,).

        Errors of F are divided by the largest depth of a cap, those of a load by the sum of this load and of
        the loads 2 a s, by which adhesion lowers those of the caps.
        """
        return _largest(*self.errors)

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
        found = self.scene.solved(self.fields, self.closed, both, True)
        by_area, by_load = found[..., 0], found[..., 1]
        total = by_load.sum(axis=1, keepdims=True)
        share = by_load / np.where(total > 0.0, total, 1.0)
        return np.asarray(by_area - by_area.sum(axis=1, keepdims=True) * share)


def joined(parts: list[States]) -> States:
    """Return the states of several parts."""
    closed, a, x, value, by_load, by_radius, by_approach = (
        np.concatenate(each)
        for each in zip(*((part.closed, part.a, part.x, *part.condition) for part in parts), strict=True)
    )
    return States(parts[0].scene, closed, a, x, (value, by_load, by_radius, by_approach))
