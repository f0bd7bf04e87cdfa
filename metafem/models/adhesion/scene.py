"""Equations of interacting adhesive contacts, and their derivatives; loads are P/E* [mm^2].

The unknowns are the contact radii a_i and the approach x. The law of one contact depends on the curvature k
of the displacement field of the other contacts. The equations are of order 3, as in `_kernels.coupling`:

    F_i = d(a_i, k_i) + u_i - (x - gap_i) = 0,    p_i = P(a_i, k_i),    k = L p/2,    g = S p,
    u = G p + L^T M/4 - S^T (Q g) - r |g|^2/2

with the influence G, its Laplacian L and its gradient S between the sites. A contact on a slope g moves down
the slope. The slope of the field shifts a paraboloid by R g, so that r = R and Q = p R. Then u is the
derivative of the energy sum U*(p, k) - p R |g|^2/2 + p.G p/2. For other caps the slope also changes d, P and
M, and an energy exists up to terms in g^4; see `slopes`. In order 1, L = S = 0.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs, dsytrf

from metafem._kernels.coupling import Coupling
from metafem._validate import FloatArray, IntArray
from metafem.contact import JKR
from metafem.contact.adhesion import of_sizes
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import sizes_of
from metafem.models.adhesion.slopes import Slopes


@dataclass(frozen=True)
class Scene:
    """Asperities with an adhesive law and their influence on each other; arrays (n,)."""

    law: JKR  # for a material
    radius: FloatArray
    gap: FloatArray
    coupling: Coupling
    self_term: FloatArray

    @cached_property
    def order(self) -> int:
        """Order of the coupling: 1 for point loads, 3 with the terms of the next order."""
        return 3 if self.coupling.laplacian.size else 1

    @cached_property
    def entry_radius(self) -> FloatArray:
        """Contact radius (n,) [mm] after the jump into contact at d = 0, without extra curvature."""
        return of_sizes(JKR.entry_radius, self.law, self.radius)

    def entry_radius_at(self, entering: IntArray, closed: IntArray, p: FloatArray) -> FloatArray:
        """Return contact radii [mm] after jumps into contact in the field of contacts with loads p [mm^2]."""
        if self.order == 1 or self.paraboloid:
            return np.asarray(self.entry_radius[entering])
        k = 0.5 * self.coupling.laplacian[np.ix_(entering, closed)] @ p
        return self.law.contact_radius(np.zeros(len(entering)), self.radius[entering], k)

    @cached_property
    def least_radius(self) -> FloatArray:
        """Lower bound (n,) [mm] of contact radii in equilibrium: half the radius at the end of the branch.

        It is 0 for caps other than paraboloids, because the curvature of the neighbours' field can sharpen a
        flat summit and thus reduce the radius.
        """
        if not self.paraboloid:
            return np.zeros(len(self.radius))
        return 0.5 * of_sizes(JKR.break_radius, self.law, self.radius)

    @cached_property
    def largest_radius(self) -> FloatArray:
        """Largest contact radius (n,) [mm] that the cap describes."""
        cap = self.law.cap
        most = np.minimum(cap.largest_indentation(self.radius), 1e3 * sizes_of(self.radius))
        return np.asarray(cap.contact_radius(most, self.radius))

    @cached_property
    def paraboloid(self) -> bool:
        """Whether the cap is a paraboloid."""
        return self.law.cap == PARABOLOID


class Fields(NamedTuple):
    """Fields at the contacts, and the values of the law in these fields; arrays (m,)."""

    load: FloatArray  # P(a, k) [mm^2]
    moment: FloatArray  # M [mm^4]
    curvature: FloatArray  # k [1/mm]
    slope_x: FloatArray
    slope_y: FloatArray
    tilt: FloatArray  # Q [mm^3]
    turn: FloatArray  # r [mm]
    displacement: FloatArray  # u [mm]
    depth: FloatArray  # indentation of the cap, d + s [mm]
    indentation: FloatArray  # d [mm]


class Contacts:
    """The equations of the asperities in contact, whose indices are `closed`."""

    def __init__(self, scene: Scene, closed: IntArray) -> None:
        self.scene, self.closed = scene, closed
        open_ones = np.ones(len(scene.gap), dtype=bool)
        open_ones[closed] = False
        self.others: IntArray = np.flatnonzero(open_ones)
        self.radius = scene.radius[closed]
        self.gap = scene.gap[closed]
        self.least_radius = scene.least_radius[closed]
        self.largest_radius = scene.largest_radius[closed]
        coupling = scene.coupling
        rows = np.ix_(closed, closed)
        self.influence = coupling.influence[rows].T.copy()
        self.influence[np.diag_indices(len(closed))] += scene.self_term[closed]
        if scene.order == 3:
            self.fields = np.stack([coupling.laplacian[rows], coupling.slope_x[rows], coupling.slope_y[rows]])

    def respond(self, a: FloatArray, p: FloatArray) -> Fields:
        """Return the fields and law values of contacts with radii a [mm] and loads p [mm^2]."""
        law, radius, none = self.scene.law, self.radius, np.zeros(len(a))
        if self.scene.order == 1:
            load, moment = law.load(a, radius), none
            depth = law.cap.indentation(a, radius)
            u = self.influence @ p
            return Fields(load, moment, none, none, none, none, none, u, depth, depth - law.deficit(a))
        doubled, gx, gy = self.fields @ p
        k = 0.5 * doubled
        depth, steepness = law.cap.indentation(a, radius, k), gx**2 + gy**2
        if self.scene.paraboloid:
            load, moment = law.load(a, radius, k), law.second_moment(a, radius, k)
            tilt, turn, indentation = radius * p, radius, depth - law.deficit(a)
        else:
            load, moment, tilt, turn, indentation = self._slopes_of(a, k, steepness).values
        u = self.influence @ p - 0.5 * turn * steepness
        for matrix, weight in zip(self.fields, (0.25 * moment, -tilt * gx, -tilt * gy), strict=True):
            u += weight @ matrix
        return Fields(load, moment, k, gx, gy, tilt, turn, u, depth, indentation)

    def within(self, a: FloatArray, found: Fields) -> bool:
        """Return whether the expansion about the summits holds; for paraboloids it always does."""
        if self.scene.order == 1 or self.scene.paraboloid:
            return True
        return self._slopes_of(a, found.curvature, found.slope_x**2 + found.slope_y**2).within

    def _slopes_of(self, a: FloatArray, k: FloatArray, steepness: FloatArray) -> Slopes:
        return Slopes(self.scene.law, self.radius, a, k, steepness)

    @cached_property
    def _outward(self) -> FloatArray:
        """Influence of m contacts on the open asperities, for order 3 with derivatives, (1 or 4, m, rest)."""
        coupling, rows = self.scene.coupling, np.ix_(self.closed, self.others)
        if self.scene.order == 1:
            return np.asarray(coupling.influence[rows][None])
        parts = (coupling.influence, coupling.laplacian, coupling.slope_x, coupling.slope_y)
        return np.stack([matrix[rows] for matrix in parts])

    @cached_property
    def _slopes(self) -> FloatArray:
        """Slopes at the open asperities per unit load of the contacts, (2, rest, m)."""
        coupling, rows = self.scene.coupling, np.ix_(self.others, self.closed)
        return np.stack([coupling.slope_x[rows], coupling.slope_y[rows]])

    def overlap(self, p: FloatArray, found: Fields, x: float) -> FloatArray:
        """Return the overlap of the open asperities with the plane [mm]; minus the gap if there is one."""
        scene, outward = self.scene, self._outward
        if scene.order == 1:
            u = p @ outward[0]
        else:
            weights = (p, 0.25 * found.moment, -found.tilt * found.slope_x, -found.tilt * found.slope_y)
            u = np.concatenate(weights) @ outward.reshape(4 * len(p), len(self.others))
            if scene.paraboloid:
                u -= 0.5 * scene.radius[self.others] * ((self._slopes @ p) ** 2).sum(axis=0)
        return np.asarray(x - scene.gap[self.others] - u)

    def linearise(self, a: FloatArray, found: Fields) -> Linear:
        """Return the derivatives of F and p with respect to the contact radii."""
        law, radius, k = self.scene.law, self.radius, found.curvature
        slope, s = law.profile_slope(a, radius, k), law.deficit(a)
        by_depth = slope - 0.5 * s / a  # dd/da
        by_load = 2.0 * a * slope - 3.0 * s  # dP/da
        diagonal = np.diag_indices(len(a))
        if self.scene.order == 1:
            matrix = self.influence * by_load
            matrix[diagonal] += by_depth
            return Linear(matrix, self.influence, by_load, by_depth, by_load, None)
        if not self.scene.paraboloid:
            return self._linearise_on_slopes(a, found)
        lap, sx, sy = self.fields
        gx, gy, tilt, turn = found.slope_x, found.slope_y, found.tilt, found.turn
        by_moment = 4.0 / 3.0 * a**3 * slope - 14.0 / 3.0 * a**2 * s  # dM/da
        # coefficients of the terms from L^T L (half of dM/dk) and S^T S
        factors = np.stack([a**5 / 15.0, -tilt, -tilt])
        by_loads = self.fields.reshape(-1, len(a)).T @ (factors[:, :, None] * self.fields).reshape(-1, len(a))
        by_loads += self.influence + (0.5 * a**2)[:, None] * lap
        by_loads -= (turn * gx)[:, None] * sx + (turn * gy)[:, None] * sy
        by_loads -= sx.T * (turn * gx) + sy.T * (turn * gy)
        direct = lap.T * (0.25 * by_moment)
        direct[diagonal] += by_depth
        mixed = (-2.0 / 3.0 * a**3)[:, None] * lap
        return _eliminated(direct, by_loads, mixed, by_depth, by_load)

    def _linearise_on_slopes(self, a: FloatArray, found: Fields) -> Linear:
        """Return the derivatives for caps other than paraboloids, whose law depends on the slopes."""
        (lap, sx, sy), gx, gy = self.fields, found.slope_x, found.slope_y
        steepness = gx**2 + gy**2
        given = self._slopes_of(a, found.curvature, steepness)
        by_a, by_k, by_g = given.derivatives()
        bend = 0.5 * lap  # dk/dp
        steep = (2.0 * gx)[:, None] * sx + (2.0 * gy)[:, None] * sy  # d|g|^2/dp
        by_curve = by_k.indentation - 0.5 * by_k.turn * steepness
        by_slope = by_g.indentation - 0.5 * found.turn
        by_loads = self.influence + by_curve[:, None] * bend + by_slope[:, None] * steep
        by_loads += 0.25 * lap.T @ (by_k.moment[:, None] * bend + by_g.moment[:, None] * steep)
        direct = lap.T * (0.25 * by_a.moment)
        direct[np.diag_indices(len(a))] += by_a.indentation - 0.5 * by_a.turn * steepness
        tilting = by_k.tilt[:, None] * bend + by_g.tilt[:, None] * steep
        for matrix, gradient in ((sx, gx), (sy, gy)):
            by_loads -= matrix.T @ (found.tilt[:, None] * matrix + gradient[:, None] * tilting)
            direct -= matrix.T * (gradient * by_a.tilt)
        mixed = -by_k.load[:, None] * bend - by_g.load[:, None] * steep
        return _eliminated(direct, by_loads, mixed, by_a.indentation, by_a.load)


def _eliminated(
    direct: FloatArray, by_loads: FloatArray, mixed: FloatArray, by_depth: FloatArray, by_load: FloatArray
) -> Linear:
    """Return the derivatives with loads that follow the radii; direct: dF/da at fixed loads, (m, m).

    mixed: minus the derivatives of the loads P by the loads through the fields; by_load: dP/da, (m,).
    """
    mixed[np.diag_indices(len(by_load))] += 1.0
    factor, pivot, _ = dgetrf(mixed)
    loads = dgetrs(factor, pivot, np.diag(by_load))[0]
    return Linear(direct + by_loads @ loads, by_loads, loads, by_depth, by_load, (factor, pivot))


@dataclass(frozen=True)
class Linear:
    """Derivatives of the equations of m contacts."""

    by_radius: FloatArray  # dF/da, including the change of the loads with a, (m, m) [-]
    by_loads: FloatArray  # dF/dp, (m, m) [1/mm]
    loads: FloatArray  # dp/da, (m, m) or its diagonal [mm]
    own_depth: FloatArray  # dd/da of the law of each contact, (m,) [-]
    own_load: FloatArray  # dP/da of the law of each contact, (m,) [mm]
    mixed: tuple[FloatArray, IntArray] | None = field(repr=False)  # LU factors of the equations p = P(a, k)

    @property
    def total(self) -> FloatArray:
        """Derivative of the total load with respect to the contact radii, (m,) [mm]."""
        return self.loads if self.loads.ndim == 1 else np.asarray(self.loads.sum(axis=0))

    @property
    def excess(self) -> int:
        """Number of unstable directions at fixed approach.

        With H = dF/dp, the contacts are stable if the number of negative eigenvalues of H equals the number
        of contacts whose load decreases with their radius. H is scaled by the square roots of |dP/da|, and
        small terms of order 3 are omitted. The number may therefore be wrong where a direction becomes
        unstable.
        """
        falling = self.own_load < 0.0
        if not falling.any():
            return 0
        root = np.sqrt(np.abs(self.own_load))
        matrix = root[:, None] * (0.5 * (self.by_loads + self.by_loads.T)) * root
        matrix[np.diag_indices(len(root))] += np.where(falling, -self.own_depth, self.own_depth)
        blocks, pivot, _ = dsytrf(matrix)
        # a 2 x 2 block of the factorisation has one negative eigenvalue
        single = pivot >= 0
        negative = (np.diagonal(blocks)[single] < 0.0).sum() + (~single).sum() // 2
        return abs(int(falling.sum()) - int(negative))

    def along(self, change: FloatArray) -> FloatArray:
        """Return the change of the loads (m,) due to a change of the contact radii (m,)."""
        return np.asarray(self.loads * change if self.loads.ndim == 1 else self.loads @ change)

    def corrected(self, error: FloatArray) -> FloatArray:
        """Return the change of the loads (m,) that removes the error of p = P(a, k)."""
        if self.mixed is None:
            return -error
        return np.asarray(-dgetrs(*self.mixed, error)[0])
