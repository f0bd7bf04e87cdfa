"""Equations of interacting adhesive contacts, and their derivatives; loads are P/E* [mm^2].

The unknowns are the contact radii a_i and the approach x. The other contacts act as point loads:

    F_i = d(a_i) + u_i - (x - gap_i) = 0,    u = G p,    p_i = P(a_i),

with the influence G between the sites. Open asperities must not overlap the plane.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dsytrf

from metafem._validate import FloatArray, IntArray
from metafem.contact import JKR
from metafem.contact.adhesion import of_sizes
from metafem.contact.law import sizes_of


@dataclass(frozen=True)
class Scene:
    """Asperities with an adhesive law and their influence on each other; arrays (n,), influence (n, n)."""

    law: JKR  # for a material
    radius: FloatArray
    gap: FloatArray
    influence: FloatArray
    self_term: FloatArray

    @cached_property
    def entry_radius(self) -> FloatArray:
        """Contact radius (n,) [mm] after the jump into contact at d = 0."""
        return of_sizes(JKR.entry_radius, self.law, self.radius)

    @cached_property
    def least_radius(self) -> FloatArray:
        """Lower bound (n,) [mm] of contact radii in equilibrium: half the radius at the end of the branch."""
        return 0.5 * of_sizes(JKR.break_radius, self.law, self.radius)

    @cached_property
    def largest_radius(self) -> FloatArray:
        """Largest contact radius (n,) [mm] that the cap describes."""
        cap = self.law.cap
        most = np.minimum(cap.largest_indentation(self.radius), 1e3 * sizes_of(self.radius))
        return np.asarray(cap.contact_radius(most, self.radius))


class Fields(NamedTuple):
    """Values of the law at contact radii, and the displacements by the other contacts; arrays (m,)."""

    load: FloatArray  # P(a) [mm^2]
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
        self.influence = scene.influence[np.ix_(closed, closed)].T.copy()
        self.influence[np.diag_indices(len(closed))] += scene.self_term[closed]

    def respond(self, a: FloatArray) -> Fields:
        """Return the values of the law and the displacements at contact radii a [mm]."""
        law = self.scene.law
        load, depth = law.load(a, self.radius), law.cap.indentation(a, self.radius)
        return Fields(load, self.influence @ load, depth, depth - law.deficit(a))

    @cached_property
    def outward(self) -> FloatArray:
        """Influence of the contacts on the open asperities, (m, rest)."""
        return self.scene.influence[np.ix_(self.closed, self.others)]

    def overlap(self, p: FloatArray, x: float) -> FloatArray:
        """Return the overlap of the open asperities with the plane [mm]; minus the gap if there is one."""
        return np.asarray(x - self.scene.gap[self.others] - p @ self.outward)

    def linearise(self, a: FloatArray) -> Linear:
        """Return the derivatives of F and p with respect to the contact radii."""
        law = self.scene.law
        slope, s = law.profile_slope(a, self.radius), law.deficit(a)
        by_depth = slope - 0.5 * s / a  # dd/da
        by_load = 2.0 * a * slope - 3.0 * s  # dP/da
        matrix = self.influence * by_load
        matrix[np.diag_indices(len(a))] += by_depth
        return Linear(matrix, self.influence, by_load, by_depth)


@dataclass(frozen=True)
class Linear:
    """Derivatives of the equations of m contacts."""

    by_radius: FloatArray  # dF/da, including the change of the loads with a, (m, m) [-]
    influence: FloatArray  # dF/dp, (m, m) [1/mm]
    load: FloatArray  # dP/da of each contact, (m,) [mm]
    depth: FloatArray  # dd/da of each contact, (m,) [-]

    @property
    def excess(self) -> int:
        """Number of unstable directions at fixed approach.

        With H = dF/dp, the contacts are stable if the number of negative eigenvalues of H equals the number
        of contacts whose load decreases with their radius. H is scaled by the square roots of |dP/da|.
        """
        falling = self.load < 0.0
        if not falling.any():
            return 0
        root = np.sqrt(np.abs(self.load))
        matrix = root[:, None] * (0.5 * (self.influence + self.influence.T)) * root
        matrix[np.diag_indices(len(root))] += np.where(falling, -self.depth, self.depth)
        blocks, pivot, _ = dsytrf(matrix)
        # a 2 x 2 block of the factorisation has one negative eigenvalue
        single = pivot >= 0
        negative = (np.diagonal(blocks)[single] < 0.0).sum() + (~single).sum() // 2
        return abs(int(falling.sum()) - int(negative))
