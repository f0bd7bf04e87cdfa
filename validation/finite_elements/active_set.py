"""One contact by an active-set method, on a uniform mesh of quadratic scikit-fem elements."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.sparse import bmat, csr_matrix
from skfem import Basis, BilinearForm, ElementQuad1, ElementQuad2, ElementVector, MeshQuad

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.caps.shapes import sphere_profile
from metafem.errors import NotConverged, refuse_if
from metafem.fe.elements import solve
from metafem.fe.geometry import Cap, checked_cap, named

# Radius of the region with equal cells, and radius of the mesh of the half-space, in contact radii.
REACH, EXTENT = 1.1, 1e5

# Size ratio of neighbouring cells beyond the contact, for a cap on a block.
GROWTH = 1.4

# Pivot threshold for mixed elements whose pressures are not eliminated: the diagonal is zero for nu = 0.5.
THRESHOLD = 1e-3

# Maximum number of changes of the active set; a few are usually enough.
STEPS = 50


@dataclass(frozen=True, eq=False)
class ActiveSetContact:
    """Contact under a rigid plane at a given indentation, from an active-set method.

    Attributes
    ----------
    rescaled_load : float
        P/E* [mm^2].
    contact_radius : float
        a [mm], from the second moment of the pressure: ``sqrt(5/2 <r^2>)``. This is exact for Hertz's
        pressure, but not for the pressure on a spherical cap.
    last_radius : float
        Radius of the last closed node [mm].
    steps : int
        Changes of the active set.

    Examples
    --------
    >>> search_contact(0.01, 1.0, cell=0.02).steps < 10
    True
    """

    rescaled_load: float
    contact_radius: float
    last_radius: float
    steps: int


def search_contact(
    indentation: float,
    radius: float,
    poisson_ratio: float = 0.5,
    *,
    cell: float,
    height: float | None = None,
    thickness: float | None = None,
    block_radius: float | None = None,
) -> ActiveSetContact:
    """Return the contact of a paraboloid on a half-space, or of a cap on a block, by an active-set method.

    At each node, force and gap are not negative and at least one of them is zero. The elements and the
    treatment of the edge differ from those of `press`, so that the two computations are independent. The
    error is at most of first order in the cell size.

    Parameters
    ----------
    indentation : float
        d [mm], positive.
    radius : float
        R of the summit [mm], positive.
    poisson_ratio : float
        nu [-], from 0 to 0.5; default: 0.5.
    cell : float
        Size of the elements along the surface [mm], at most a quarter of the contact radius.
    height, thickness, block_radius : float, optional
        Height of a spherical cap, and thickness and radius of the block below it [mm]. The block has a bonded
        base and a free side. Give all three or none.

    Returns
    -------
    ActiveSetContact

    Raises
    ------
    InvalidInput
        If a value is outside its range, the cell is too large for the contact, or only some of height,
        thickness and block_radius are given.
    NotConverged
        If the active set still changes after the largest number of steps.

    Examples
    --------
    >>> contact = search_contact(0.01, 1.0, cell=0.01)
    >>> abs(contact.rescaled_load / (4 / 3 * 0.01**1.5) - 1) < 0.01
    True
    """
    depth = check.number("indentation", indentation, above=0.0)
    big = check.number("radius", radius, above=0.0)
    nu = check.number("poisson_ratio", poisson_ratio, **check.POISSON)
    size = math.sqrt(depth * big)
    width = check.number("cell", cell, above=0.0, at_most=0.25 * size)
    if height is not None and thickness is not None and block_radius is not None:
        cap = checked_cap(REACH * size, big, height, thickness, "block_radius", block_radius)
        r, flexibility = _flexibility(_cap_mesh(cap, width, REACH * size), nu)
        force, steps = _active_set(flexibility, depth - sphere_profile(r, big))
        return _of_forces(force, r, steps)
    refuse_if(
        not height is thickness is block_radius is None,
        "height, thickness and block_radius of a cap on a block must be given together",
    )
    # in units of Hertz's contact radius, a^2 = R d
    r, flexibility = _flexibility(uniform_mesh(width / size, REACH, EXTENT), nu)
    force, steps = _active_set(flexibility, 1.0 - 0.5 * r**2)
    return _of_forces(depth * size * force, size * r, steps)


def _of_forces(force: FloatArray, r: FloatArray, steps: int) -> ActiveSetContact:
    """Return the contact that has these nodal forces at the radii r."""
    return ActiveSetContact(
        rescaled_load=math.fsum(force),
        contact_radius=math.sqrt(2.5 * math.fsum(force * r**2) / math.fsum(force)),
        last_radius=float(r[force > 0.0].max()),
        steps=steps,
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


def _active_set(flexibility: FloatArray, depth: FloatArray) -> tuple[FloatArray, int]:
    """Return forces >= 0 with ``flexibility force >= depth``, equal where force > 0, and the step count."""
    active = depth > 0.0
    for step in range(1, STEPS + 1):
        force = np.zeros(len(depth))
        force[active] = np.linalg.solve(flexibility[np.ix_(active, active)], depth[active])
        overlap = depth - flexibility @ force
        # Active nodes overlap by rounding errors only, so they stay closed while their force is positive.
        following = np.where(active, force > 0.0, overlap > 0.0)
        if (following == active).all():
            return force, step
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
