"""One contact by an active-set method, on a uniform mesh of quadratic scikit-fem elements."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import bmat, csr_matrix
from skfem import Basis, BilinearForm, ElementQuad1, ElementQuad2, ElementVector, MeshQuad

from metafem._validate import FloatArray, IntArray
from metafem.caps.shapes import sphere_profile
from metafem.errors import NotConverged
from metafem.fe.elements import solve
from metafem.fe.geometry import Cap, named

# Radius of the region with equal cells, and radius of the mesh of the half-space, in contact radii.
REACH, EXTENT = 1.1, 1e5

# Size ratio of neighbouring cells beyond the contact, for a cap on a block.
GROWTH = 1.4

# Pivot threshold for mixed elements whose pressures are not eliminated: the diagonal is zero for nu = 0.5.
THRESHOLD = 1e-3

# Maximum number of changes of the active set; a few are usually enough.
STEPS = 50


class ActiveSetContact(NamedTuple):
    """Load P/E* [mm²], and radii [mm] by the second moment of the pressure and of the last closed node.

    The second moment, ``sqrt(5/2 <r^2>)``, is exact for Hertz's pressure, not for that on a spherical cap.
    """

    rescaled_load: float
    contact_radius: float
    last_radius: float


def search_contact(
    indentation: float, radius: float, nu: float = 0.5, *, cell: float, cap: Cap | None = None
) -> ActiveSetContact:
    """Return the contact of a paraboloid on a half-space, or of a cap on a block, at an indentation [mm].

    At each node, force and gap are not negative and at least one of them is zero. The elements, of a size
    `cell` [mm] along the surface, and the treatment of the edge differ from those of `press`, so that the two
    computations are independent. The error is at most of first order in the cell size.
    """
    size = math.sqrt(indentation * radius)
    if cap is not None:
        r, flexibility = _flexibility(_cap_mesh(cap, cell, REACH * size), nu)
        return _of_forces(_active_set(flexibility, indentation - sphere_profile(r, radius)), r)
    # in units of Hertz's contact radius, a^2 = R d
    r, flexibility = _flexibility(uniform_mesh(cell / size, REACH, EXTENT), nu)
    force = _active_set(flexibility, 1.0 - 0.5 * r**2)
    return _of_forces(indentation * size * force, size * r)


def _of_forces(force: FloatArray, r: FloatArray) -> ActiveSetContact:
    """Return the contact that has these nodal forces at the radii r."""
    return ActiveSetContact(
        rescaled_load=math.fsum(force),
        contact_radius=math.sqrt(2.5 * math.fsum(force * r**2) / math.fsum(force)),
        last_radius=float(r[force > 0.0].max()),
    )


def uniform_mesh(cell: float, reach: float, outer: float, growth: float = 1.3) -> MeshQuad:
    """Return a mesh with equal cells up to r = reach; outside and below this region the cells grow."""
    count = round(reach / cell)
    near = cell * np.arange(count + 1)
    size = cell * growth ** np.arange(1, 1 + math.ceil(math.log(1.0 + outer / cell) / math.log(growth)))
    s = np.concatenate([near, near[-1] + np.cumsum(size)])
    depth = np.concatenate([[0.0, cell], cell + np.cumsum(size)])
    return named(MeshQuad.init_tensor(s, depth), near[-1], s[-1], depth[-1])


def _cap_mesh(cap: Cap, cell: float, reach: float) -> MeshQuad:
    """Return a mesh of a cap on a block: equal cells up to `reach`, then growing cells to foot and side."""
    near = cell * np.arange(round(reach / cell) + 1)
    slope = _growing(near[-1], cap.foot, cell)
    flat = _growing(cap.foot, cap.outer, slope[-1] - slope[-2])
    s = np.concatenate([near, slope[1:], flat[1:]])
    depth = _growing(0.0, cap.thickness, cell)
    plane = named(MeshQuad.init_tensor(s, depth), near[-1], cap.outer, cap.thickness)
    return replace(plane, doflocs=cap.point(plane.p))


def _growing(start: float, end: float, first: float) -> FloatArray:
    """Return positions from start to end; spacings begin with `first` and grow by at most `GROWTH`."""
    count = max(1, math.ceil(math.log1p((end - start) / first * (GROWTH - 1.0)) / math.log(GROWTH)))
    sums = np.cumsum(GROWTH ** np.arange(count))
    return np.concatenate([[start], start + (end - start) * sums[:-1] / sums[-1], [end]])


def _active_set(flexibility: FloatArray, depth: FloatArray) -> FloatArray:
    """Return forces >= 0 with ``flexibility force >= depth``, equal where force > 0."""
    active = depth > 0.0
    for _ in range(STEPS):
        force = np.zeros(len(depth))
        force[active] = np.linalg.solve(flexibility[np.ix_(active, active)], depth[active])
        overlap = depth - flexibility @ force
        # Active nodes overlap by rounding errors only, so they stay closed while their force is positive.
        following = np.where(active, force > 0.0, overlap > 0.0)
        if (following == active).all():
            return force
        active = following
    raise NotConverged(f"the active set still changes after {STEPS} steps")


def _flexibility(mesh: MeshQuad, nu: float) -> tuple[FloatArray, FloatArray]:
    """Return the radii of nodes near the contact, and their displacements per unit force on each ring."""
    displacement = Basis(mesh, ElementVector(ElementQuad2()), intorder=5)
    pressure = displacement.with_element(ElementQuad1())
    matrix = _matrix(displacement, pressure, nu)
    names = displacement.get_dofs(["axis", "base"]).all(["u^1"]), displacement.get_dofs("base").all(["u^2"])
    touch: IntArray = displacement.get_dofs("contact").all(["u^2"])
    unit = np.zeros((matrix.shape[0], len(touch)))
    # Positive forces point down, along depth. The force on a ring is 2 pi times the force per radian.
    unit[touch, np.arange(len(touch))] = 1.0 / (2.0 * math.pi)
    value, _ = solve(matrix, np.concatenate(names), np.zeros_like(unit), unit, THRESHOLD)
    return displacement.doflocs[0, touch], value[touch]


def _matrix(displacement: Basis, pressure: Basis, nu: float) -> csr_matrix:
    """Return the mixed stiffness matrix for E* = 1, per radian."""
    mu, compliance = 0.5 * (1.0 - nu), 3.0 * (1.0 - 2.0 * nu) / (1.0 - nu**2)

    def shear(u: Any, v: Any, w: Any) -> Any:
        r = w.x[0]
        hoop, other = u[0] / r, v[0] / r
        one, two = u.grad[0, 0] + u.grad[1, 1] + hoop, v.grad[0, 0] + v.grad[1, 1] + other
        direct = u.grad[0, 0] * v.grad[0, 0] + u.grad[1, 1] * v.grad[1, 1] + hoop * other
        across = (u.grad[0, 1] + u.grad[1, 0]) * (v.grad[0, 1] + v.grad[1, 0])
        return mu * (2.0 * direct + across - 2.0 / 3.0 * one * two) * r

    def dilation(u: Any, q: Any, w: Any) -> Any:
        return -(u.grad[0, 0] + u.grad[1, 1] + u[0] / w.x[0]) * q * w.x[0]

    def mass(p: Any, q: Any, w: Any) -> Any:
        return -compliance * p * q * w.x[0]

    block = BilinearForm(dilation).assemble(displacement, pressure)
    return bmat(
        [
            [BilinearForm(shear).assemble(displacement), block.T],
            [block, BilinearForm(mass).assemble(pressure)],
        ],
        format="csr",
    )
