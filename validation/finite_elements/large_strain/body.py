"""Mixed elements at large strain, and Newton's method for a body flattened up to a material radius."""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from scipy.sparse import csc_matrix
from skfem import ElementQuadP

from metafem._validate import FloatArray, IntArray
from metafem.errors import NotConverged
from metafem.fe.elements import Body, assembled, solve
from metafem.fe.prescribed_radius import Profile
from validation.finite_elements.active_set import THRESHOLD
from validation.finite_elements.large_strain import neo_hookean

# scikit-fem advises to use nodal elements for low degrees; those of `Body` are hierarchical.
logging.getLogger(ElementQuadP.__module__).setLevel(logging.ERROR)

# Largest number of Newton steps; each step doubles the number of correct digits. If Newton's method has not
# converged by then, the load step is halved.
NEWTON = 12

# Bounds of a converged state: largest unbalanced nodal force over the load, and last change over the largest
# displacement. The second bound may be far above rounding, because the next step would square the change.
RESIDUAL, CHANGE = 1e-8, 1e-6

# Smallest load step, as a fraction of the indentation.
SMALLEST_STEP = 1.0 / 64.0


@dataclass(frozen=True, eq=False)
class FiniteContact:
    """Contact of a soft cap under a rigid plane at large strain.

    Attributes
    ----------
    contact_radius : float
        a, in the deformed state [mm].
    material_radius : float
        Undeformed radius of the points at the edge of the contact [mm].
    rescaled_load : float
        P/E* [mm^2], E* = 4/3 E = 4 mu.
    indentation : float
        Displacement of the plane from first contact [mm].
    error_estimate : float
        Bound of the relative discretisation errors of load and indentation [-]. It includes the change when
        the mesh is refined, the bracket of the contact's edge and, with stick, the change when the number of
        earlier contacts is halved.
    residual : float
        Largest unbalanced nodal force, relative to the load [-].
    """

    contact_radius: float
    material_radius: float
    rescaled_load: float
    indentation: float
    # for a single mesh, the relative change of load (at the same deformed radius) or indentation that would
    # result if the next node outside were also in contact
    error_estimate: float
    residual: float
    energy: float  # stored energy over E* [mm^3]
    shift: float  # amplitude of the last term of the radial displacement of sticking points
    fraction: float  # fraction of the prescribed displacements that is applied; 1 for a complete state
    unknowns: FloatArray = field(repr=False)  # radial and downward displacements, pressures


@dataclass(frozen=True, eq=False)
class Plane:
    """Prescribed displacements: the `fixed` unknowns have the values ``fraction way + modes amplitudes``.

    The amplitudes are the indentation and, with stick, the shift; they make the forces on the unknowns `edge`
    vanish. `depth` is the depth of the next node outside, below the summit [mm].
    """

    fixed: IntArray
    way: FloatArray
    modes: FloatArray
    edge: IntArray
    depth: float


class SoftBody(Body):
    """Axisymmetric, incompressible neo-Hookean body with E* = 1, in the undeformed configuration."""

    @cached_property
    def _shapes(self) -> tuple[FloatArray, ...]:
        return self.shapes_at_points(np.arange(self.mesh.nelements))

    @cached_property
    def all_numbers(self) -> IntArray:
        """Global numbers of the unknowns of each element, including bubbles, (elements, local)."""
        mine, other = self.displacement.dofs.element_dofs, self.pressure.dofs.element_dofs
        return np.vstack([mine, mine + self.count, other + 2 * self.count]).T

    @property
    def count(self) -> int:
        """Number of coefficients of one displacement component."""
        return int(self.displacement.dofs.N)

    @property
    def size(self) -> int:
        """Number of unknowns."""
        return 2 * self.count + int(self.pressure.dofs.N)

    def deform(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the displacement gradients (elements, points, 5) and pressures (elements, points)."""
        along_r, along_z, hoop, other, _ = self._shapes
        local = self.displacement.local
        mine = unknowns[self.all_numbers]
        u, v, p = mine[:, :local, None], mine[:, local : 2 * local, None], mine[:, 2 * local :]
        columns = [along_r @ u, along_z @ u, along_r @ v, along_z @ v, hoop @ u]
        return np.concatenate(columns, axis=-1), p @ other.T

    def balance(self, gradient: FloatArray, pressure: FloatArray) -> tuple[csc_matrix, FloatArray]:
        """Return the tangent matrix and the nodal forces, both over 2 pi."""
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
        total = np.bincount(number.ravel(), np.hstack([inner, swelling]).ravel(), minlength=self.size)
        return assembled(number, block, self.size), np.asarray(total, dtype=np.float64)

    def flatten(
        self,
        profile: Profile,
        stuck: tuple[Profile, ...] | None = None,
        start: FiniteContact | None = None,
    ) -> FiniteContact:
        """Return the state with the boundary `contact` flat on the plane and no force at its edge.

        `profile` is the depth below the summit [mm] at the undeformed radii. `stuck` holds the known radial
        displacement [mm] of sticking points and a term of unknown amplitude; default: the points slip.
        `start` is a complete state on a mesh with the same numbering. Raise NotConverged, with the last
        state, if Newton's method fails even with the smallest load step.
        """
        plane = self._plane(profile, stuck)
        at_rest = (0.0, 0.0, 0.0, 0.0, math.inf, 0.0, 0.0, 0.0, 0.0)
        last = FiniteContact(*at_rest, np.zeros(self.size))
        if start is not None:
            amplitudes = np.array([start.indentation, start.shift])[: plane.modes.shape[1]]
            state = self._newton(plane, 1.0, start.unknowns, amplitudes)
            if state is not None:
                return state
        step = 1.0
        while last.fraction < 1.0:
            fraction = min(1.0, last.fraction + step)
            # initial guess: first the undeformed state, later a linear extrapolation of the last state
            scale = fraction / last.fraction if last.fraction > 0.0 else 1.0
            amplitudes = scale * np.array([last.indentation, last.shift])[: plane.modes.shape[1]]
            state = self._newton(plane, fraction, scale * last.unknowns, amplitudes)
            if state is not None:
                last = state
                continue
            step *= 0.5
            if step < SMALLEST_STEP:
                raise NotConverged(f"no equilibrium beyond {last.fraction:.0%} of the indentation", last)
        return last

    def _plane(self, profile: Profile, stuck: tuple[Profile, ...] | None) -> Plane:
        count, contact = self.count, self.boundary("contact")
        edge = self.edge_nodes[0]
        modes = np.zeros((self.size, 1 if stuck is None else 2))
        way = np.zeros(self.size)
        modes[contact + count, 0] = self.contact_values(np.ones_like)[contact]
        way[contact + count] = -self.contact_values(profile)[contact]
        fixed = [self.boundary("axis"), self.boundary("base"), count + self.boundary("base"), count + contact]
        edges = [count + edge]
        if stuck is not None:
            way[contact], modes[contact, 1] = (self.contact_values(part)[contact] for part in stuck)
            fixed.append(contact)
            edges.append(edge)
        depth = float(profile(self.geometry.point(self.mesh.p[:, self.edge_nodes[1:]])[0])[0])
        return Plane(np.unique(np.concatenate(fixed)), way, modes, np.array(edges), depth)

    @cached_property
    def edge_nodes(self) -> tuple[int, int]:
        """Node at the contact's edge, and the next node outside."""
        free = np.unique(self.mesh.facets[:, self.mesh.boundaries["free"]])
        first, second = free[np.argsort(self.mesh.p[0, free])][:2]
        return int(first), int(second)

    def _newton(
        self, plane: Plane, fraction: float, start: FloatArray, amplitudes: FloatArray
    ) -> FiniteContact | None:
        """Return the state at a fraction of the prescribed displacements, or None without convergence."""
        free = np.setdiff1d(np.arange(self.size), plane.fixed)
        unknowns = start.copy()
        unknowns[plane.fixed] = fraction * plane.way[plane.fixed] + plane.modes[plane.fixed] @ amplitudes
        # in the first step, `jump` moves the fixed unknowns to their values, and the tangent moves the others
        jump, unknowns, change = unknowns - start, start.copy(), math.inf
        way = np.zeros((self.size, 0))
        for _ in range(NEWTON):
            gradient, pressure = self.deform(unknowns)
            if not neo_hookean.volume_change(gradient).min() > -1.0:
                return None
            matrix, force = self.balance(gradient, pressure)
            unbalanced = np.concatenate([force[free[free < 2 * self.count]], force[plane.edge]])
            error = float(np.abs(unbalanced).max() / max(abs(self._load(force)), np.finfo(float).tiny))
            if change <= CHANGE and error <= RESIDUAL:
                edge = self.edge_nodes[0]
                material = float(self.geometry.point(self.mesh.p[:, [edge]])[0, 0])
                stored = self._shapes[4] * neo_hookean.energy(gradient, self.shear_modulus)
                return FiniteContact(
                    contact_radius=material + float(unknowns[edge]),
                    material_radius=material,
                    rescaled_load=2.0 * math.pi * self._load(force),
                    indentation=float(amplitudes[0]),
                    error_estimate=self._bracket(plane, unknowns, amplitudes, matrix, force, way),
                    residual=error,
                    energy=2.0 * math.pi * float(np.sum(stored)),
                    shift=float(amplitudes[1]) if len(amplitudes) > 1 else 0.0,
                    fraction=fraction,
                    unknowns=unknowns,
                )
            right = np.column_stack([force + matrix @ jump, matrix @ plane.modes])
            # if the tangent is singular, the guess is too far from the solution
            try:
                full, _ = solve(matrix, plane.fixed, np.zeros(right.shape), -right, THRESHOLD)
            except NotConverged:
                return None
            at_edge = (right + matrix @ full)[plane.edge]
            if np.linalg.det(at_edge[:, 1:]) == 0.0:
                return None
            step = np.linalg.solve(at_edge[:, 1:], -at_edge[:, 0])
            way = full[:, 1:] + plane.modes
            move = jump + full[:, 0] + way @ step
            unknowns, amplitudes = unknowns + move, amplitudes + step
            change = np.abs(move[: 2 * self.count]).max() / np.abs(unknowns[: 2 * self.count]).max()
            jump = np.zeros(self.size)
        return None

    def _load(self, force: FloatArray) -> float:
        """Return the force of the plane over 2 pi; the forces on bubbles of the sides do not contribute."""
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
        """Return the linearised relative change if the next node were in contact, without edge shear."""
        edge, other = self.edge_nodes
        at_edge = (matrix @ way)[plane.edge]
        mix = np.ones(1) if way.shape[1] == 1 else np.array([1.0, -at_edge[1, 0] / at_edge[1, 1]])
        sink = way @ mix
        gap = plane.depth + unknowns[self.count + other] - amplitudes[0]
        deeper = gap / (1.0 - sink[self.count + other])
        radius = self.geometry.point(self.mesh.p[:, [edge]])[0, 0] + unknowns[edge]
        load = self._load(matrix @ sink) / self._load(force) - 3.0 * sink[edge] / radius
        return float(max(abs(load * deeper), abs(deeper / amplitudes[0])))
