"""Mixed elements for large deformation, and Newton's method for a body pressed flat up to a given point."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
from scipy.sparse import coo_matrix, csc_matrix

from metafem._validate import FloatArray, IntArray
from metafem.errors import NotConverged
from metafem.fe.axisymmetric.elasticity import EXTRA_POINTS, Body
from metafem.fe.axisymmetric.prescribed_radius import Profile, contact_data
from metafem.fe.large_strain import neo_hookean
from metafem.fe.linear_solve import solve

# Newton doubles its digits: a step that has not ended after so many starts too far away and is halved.
NEWTON = 12

# Largest nodal force out of balance, relative to the load, and largest last change, relative to the
# largest displacement, of a converged state: far above rounding, and the next step would square the change.
RESIDUAL, CHANGE = 1e-8, 1e-6

# Share of its column that a diagonal pivot must have: the pressures' are zero.
THRESHOLD = 1e-3

# Smallest part of the way by which the load is raised before the solver gives up.
SMALLEST_STEP = 1.0 / 64.0


class NewtonStatus(Enum):
    """How Newton's method ended; the value is the message."""

    CONVERGED = "converged: the nodal forces balance"
    NOT_CONVERGED = "not converged: the state belongs to a part of the plane's way"


@dataclass(frozen=True, eq=False)
class Flattened:
    """A body whose surface is flat up to a material point: one discrete state.

    Attributes
    ----------
    load, indentation, edge : float
        P/E* [mm^2], the plane's way [mm], and the deformed radius of the contact's edge [mm].
    energy : float
        Stored, over E* [mm^3].
    shift : float
        Amplitude of the part of the stuck places that this state determines.
    bracket : float
        Relative change of the load at the same deformed radius, or of the indentation, if the next node
        outside touched too.
    share : float
        Part of the way to the plane, 1 for a complete state.
    residual : float
        Largest nodal force out of balance, relative to the load.
    unknowns : ndarray
        Radial and downward displacements, pressures.
    """

    load: float
    indentation: float
    edge: float
    energy: float
    shift: float
    bracket: float
    share: float
    residual: float
    unknowns: FloatArray

    @property
    def status(self) -> NewtonStatus:
        """Whether the state is complete."""
        return NewtonStatus.CONVERGED if self.share == 1.0 else NewtonStatus.NOT_CONVERGED


@dataclass(frozen=True, eq=False)
class Plane:
    """What the plane prescribes: ``fixed`` unknowns take ``share way + modes amplitudes``.

    The amplitudes (indentation; shift) are those for which the forces at ``edge`` vanish. The node next to
    it lies `depth` below the summit.
    """

    fixed: IntArray
    way: FloatArray
    modes: FloatArray
    edge: IntArray
    depth: float


class SoftBody(Body):
    """An axisymmetric incompressible neo-Hookean body of composite modulus 1, in its undeformed frame."""

    @cached_property
    def _shapes(self) -> tuple[FloatArray, ...]:
        """Rows (elements, points, local) of d/dr, d/dz, 1/r; pressures (points, local), radius, weights."""
        x, w = np.polynomial.legendre.leggauss(self.degree + EXTRA_POINTS)
        x, w = 0.5 * (x + 1.0), 0.5 * w
        place, weight = np.array(np.meshgrid(x, x)).reshape(2, -1), np.outer(w, w).ravel()
        value, slope = self.displacement.shapes(place)
        other, _ = self.pressure.shapes(place)
        radius, inverse, determinant = self._measure(place, np.arange(self.mesh.nelements))
        along_r, along_z = np.einsum("jieq,bjq->ieqb", inverse, slope, optimize=True)
        return along_r, along_z, value.T / radius[..., None], other.T, weight * np.abs(determinant) * radius

    @cached_property
    def all_numbers(self) -> IntArray:
        """Global numbers of each element's unknowns, bubbles included."""
        mine, other = self.displacement.dofs.element_dofs, self.pressure.dofs.element_dofs
        return np.vstack([mine, mine + self.count, other + 2 * self.count]).T

    @property
    def count(self) -> int:
        """Number of coefficients of one displacement."""
        return int(self.displacement.dofs.N)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 2 * self.count + int(self.pressure.dofs.N)

    def deform(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Displacement gradients (elements, points, 5) and pressures (elements, points)."""
        along_r, along_z, hoop, other, _ = self._shapes
        local = self.displacement.local
        mine = unknowns[self.all_numbers]
        u, v, p = mine[:, :local, None], mine[:, local : 2 * local, None], mine[:, 2 * local :]
        columns = [along_r @ u, along_z @ u, along_r @ v, along_z @ v, hoop @ u]
        return np.concatenate(columns, axis=-1), p @ other.T

    def balance(self, gradient: FloatArray, pressure: FloatArray) -> tuple[csc_matrix, FloatArray]:
        """Tangent and nodal forces per 2 pi."""
        along_r, along_z, hoop, other, weight = self._shapes
        count, points, local = along_r.shape
        mu = self.shear_modulus
        row = np.zeros((count, points, 5, 2 * local))
        row[:, :, 0, :local], row[:, :, 1, :local], row[:, :, 4, :local] = along_r, along_z, hoop
        row[:, :, 2, local:], row[:, :, 3, local:] = along_r, along_z
        stiff = neo_hookean.tangent(gradient, pressure, mu) * weight[..., None, None]
        flat = row.reshape(count, 5 * points, 2 * local)
        stiffness = flat.transpose(0, 2, 1) @ (stiff @ row).reshape(flat.shape)
        slope = ((neo_hookean.ONE + neo_hookean.volume_slope(gradient)) * weight[..., None])[:, :, None, :]
        mixed = -(other.T @ (slope @ row)[:, :, 0, :])
        empty = np.zeros((count, other.shape[1], other.shape[1]))
        block = np.block([[stiffness, mixed.transpose(0, 2, 1)], [mixed, empty]])
        force = neo_hookean.stress(gradient, pressure, mu) * weight[..., None]
        inner = (force.reshape(count, 1, -1) @ flat)[:, 0]
        swelling = -(neo_hookean.volume_change(gradient) * weight) @ other
        number = self.all_numbers
        width = number.shape[1]
        rows, columns = np.repeat(number, width, axis=1).ravel(), np.tile(number, (1, width)).ravel()
        matrix = coo_matrix((block.ravel(), (rows, columns)), shape=(self.size, self.size)).tocsc()
        total = np.bincount(number.ravel(), np.hstack([inner, swelling]).ravel(), minlength=self.size)
        return matrix, np.asarray(total, dtype=np.float64)

    def flatten(
        self, profile: Profile, stuck: tuple[Profile, Profile] | None = None, start: Flattened | None = None
    ) -> Flattened:
        """Flatten the surface within the boundary `contact`, without force at its edge.

        Parameters
        ----------
        profile : callable
            Height that is missing below the summit [mm] at the undeformed radii.
        stuck : pair of callables, optional
            Radial displacement [mm] of points that stick, and the mode that the state adds to it; without
            it the points slip.
        start : Flattened, optional
            A complete state on a mesh of the same numbering.

        Raises
        ------
        NotConverged
            If Newton's method fails with the smallest steps; with the last state that it reached.
        """
        plane = self._plane(profile, stuck)
        last = self._rest()
        if start is not None:
            amplitudes = np.array([start.indentation, start.shift])[: plane.modes.shape[1]]
            found = self._newton(plane, 1.0, start.unknowns, amplitudes)
            if found is not None:
                return found
        step = 1.0
        while last.share < 1.0:
            share = min(1.0, last.share + step)
            # From rest the linear answer is the guess; later on the way goes on straight.
            scale = share / last.share if last.share > 0.0 else 1.0
            amplitudes = scale * np.array([last.indentation, last.shift])[: plane.modes.shape[1]]
            found = self._newton(plane, share, scale * last.unknowns, amplitudes)
            if found is not None:
                last = found
                continue
            step *= 0.5
            if step < SMALLEST_STEP:
                raise NotConverged(f"no equilibrium beyond {last.share:.0%} of the plane's way", last)
        return last

    def _plane(self, profile: Profile, stuck: tuple[Profile, Profile] | None) -> Plane:
        count, contact = self.count, self.boundary("contact")
        edge = self.edge_nodes[0]
        modes = np.zeros((self.size, 1 if stuck is None else 2))
        way = np.zeros(self.size)
        modes[contact + count, 0] = contact_data(self, np.ones_like)[contact]
        way[contact + count] = -contact_data(self, profile)[contact]
        fixed = [self.boundary("axis"), self.boundary("base"), count + self.boundary("base"), count + contact]
        edges = [count + edge]
        if stuck is not None:
            way[contact], modes[contact, 1] = (contact_data(self, part)[contact] for part in stuck)
            fixed.append(contact)
            edges.append(edge)
        depth = float(profile(self.geometry.point(self.mesh.p[:, self.edge_nodes[1:]])[0])[0])
        return Plane(np.unique(np.concatenate(fixed)), way, modes, np.array(edges), depth)

    @cached_property
    def edge_nodes(self) -> tuple[int, int]:
        """Nodes at the contact's edge and next to it outside."""
        free = np.unique(self.mesh.facets[:, self.mesh.boundaries["free"]])
        first, second = free[np.argsort(self.mesh.p[0, free])][:2]
        return int(first), int(second)

    def _rest(self) -> Flattened:
        return Flattened(0.0, 0.0, 0.0, 0.0, 0.0, math.inf, 0.0, 0.0, np.zeros(self.size))

    def _newton(
        self, plane: Plane, share: float, start: FloatArray, amplitudes: FloatArray
    ) -> Flattened | None:
        """State with a share of the way, or None where Newton's method does not find it."""
        free = np.setdiff1d(np.arange(self.size), plane.fixed)
        unknowns = start.copy()
        unknowns[plane.fixed] = share * plane.way[plane.fixed] + plane.modes[plane.fixed] @ amplitudes
        # What is fixed moves to its place by the tangent at the start, and takes the rest of the body along.
        jump, unknowns, change = unknowns - start, start.copy(), math.inf
        way = np.zeros((self.size, 0))
        for _ in range(NEWTON):
            gradient, pressure = self.deform(unknowns)
            if not neo_hookean.volume_change(gradient).min() > -1.0:
                return None
            matrix, force = self.balance(gradient, pressure)
            wrong = np.concatenate([force[free[free < 2 * self.count]], force[plane.edge]])
            error = float(np.abs(wrong).max() / max(abs(self._load(force)), np.finfo(float).tiny))
            if change <= CHANGE and error <= RESIDUAL:
                bracket = self._bracket(plane, unknowns, amplitudes, matrix, force, way)
                return self._state(share, unknowns, amplitudes, gradient, force, error, bracket)
            right = np.column_stack([force + matrix @ jump, matrix @ plane.modes])
            full = np.zeros(right.shape)
            solved = solve(matrix[free][:, free].tocsc(), right[free], THRESHOLD)
            full[free] = -solved.value
            at_edge = (right + matrix @ full)[plane.edge]
            # a singular tangent: too far from the solution
            if not math.isfinite(solved.residual) or np.linalg.det(at_edge[:, 1:]) == 0.0:
                return None
            step = np.linalg.solve(at_edge[:, 1:], -at_edge[:, 0])
            way = full[:, 1:] + plane.modes
            move = jump + full[:, 0] + way @ step
            unknowns, amplitudes = unknowns + move, amplitudes + step
            change = np.abs(move[: 2 * self.count]).max() / np.abs(unknowns[: 2 * self.count]).max()
            jump = np.zeros(self.size)
        return None

    def _load(self, force: FloatArray) -> float:
        """Force of the plane per 2 pi: forces of bubbles on the sides add none."""
        nodes = np.unique(self.mesh.facets[:, self.mesh.boundaries["contact"]])
        return float(force[self.count + nodes].sum())

    def _bracket(
        self,
        plane: Plane,
        unknowns: FloatArray,
        amplitudes: FloatArray,
        matrix: csc_matrix,
        force: FloatArray,
        way: FloatArray,
    ) -> float:
        """Relative change if the next node touched, by the tangent; shear at the edge stays away."""
        edge, other = self.edge_nodes
        at_edge = (matrix @ way)[plane.edge]
        mix = np.ones(1) if way.shape[1] == 1 else np.array([1.0, -at_edge[1, 0] / at_edge[1, 1]])
        sink = way @ mix
        gap = plane.depth + unknowns[self.count + other] - amplitudes[0]
        deeper = gap / (1.0 - sink[self.count + other])
        radius = self.geometry.point(self.mesh.p[:, [edge]])[0, 0] + unknowns[edge]
        load = self._load(matrix @ sink) / self._load(force) - 3.0 * sink[edge] / radius
        return float(max(abs(load * deeper), abs(deeper / amplitudes[0])))

    def _state(
        self,
        share: float,
        unknowns: FloatArray,
        amplitudes: FloatArray,
        gradient: FloatArray,
        force: FloatArray,
        residual: float,
        bracket: float,
    ) -> Flattened:
        edge = self.edge_nodes[0]
        return Flattened(
            load=2.0 * math.pi * self._load(force),
            indentation=float(amplitudes[0]),
            edge=float(self.geometry.point(self.mesh.p[:, [edge]])[0, 0] + unknowns[edge]),
            energy=2.0
            * math.pi
            * float(np.sum(self._shapes[4] * neo_hookean.energy(gradient, self.shear_modulus))),
            shift=float(amplitudes[1]) if len(amplitudes) > 1 else 0.0,
            bracket=bracket,
            share=share,
            residual=residual,
            unknowns=unknowns,
        )
