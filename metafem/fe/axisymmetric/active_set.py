"""A contact search on an ordinary mesh: quadratic elements, scikit-fem's own forms, an active set."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse import bmat, csc_matrix
from skfem import Basis, BilinearForm, ElementQuad1, ElementQuad2, ElementVector, MeshQuad

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.errors import NotConverged
from metafem.fe.axisymmetric.mesh import uniform_mesh
from metafem.fe.linear_solve import LinearStatus, solve

# The cells near the contact end at this many contact radii, and the half-space at that many.
REACH, EXTENT = 1.1, 1e5

# Share of its column that a diagonal pivot must have: the pressures' are zero at nu = 0.5.
THRESHOLD = 1e-3

# An active set changes by at least one node a step and settles in a few; more is a fault.
STEPS = 50


@dataclass(frozen=True, eq=False)
class FoundContact:
    """Contact that an active set found under a plane at a given indentation.

    Attributes
    ----------
    rescaled_load : float
        P/E* [mm^2].
    contact_radius : float
        From the second moment of the pressure, ``sqrt(5/2 <r^2>)`` of a Hertzian one [mm].
    last_radius : float
        Of the last closed node [mm].
    steps : int
        Changes of the active set.
    """

    rescaled_load: float
    contact_radius: float
    last_radius: float
    steps: int


def search_contact(
    indentation: float, radius: float, poisson_ratio: float = 0.5, *, cell: float
) -> FoundContact:
    """Find the contact of a paraboloid on a half-space by an active set on a uniform mesh.

    It shares neither the elements nor the treatment of the edge with `press`, and so is independent
    evidence: nodal forces are not negative, nodal gaps neither, and one of the two is zero. The error
    falls with the cell at first order or faster.

    Parameters
    ----------
    indentation, radius : float
        Of the plane and the summit [mm].
    poisson_ratio : float
        nu in [0, 0.5].
    cell : float
        Size of the quadratic elements along the surface [mm].

    Raises
    ------
    InvalidInput
        If a value is outside its range, or the cell does not resolve the contact.
    NotConverged
        If the active set does not settle.

    Examples
    --------
    >>> found = search_contact(0.01, 1.0, cell=0.01)
    >>> abs(found.rescaled_load / (4 / 3 * 0.01**1.5) - 1) < 0.01
    True
    """
    depth = check.number("indentation", indentation, above=0.0)
    big = check.number("radius", radius, above=0.0)
    nu = check.number("poisson_ratio", poisson_ratio, **check.POISSON)
    size = math.sqrt(depth * big)
    width = check.number("cell", cell, above=0.0, at_most=0.25 * size)
    # In units of the contact's radius a^2 = R d, so that lengths of any size are solved alike.
    r, flexibility = _flexibility(uniform_mesh(width / size, REACH, EXTENT), nu)
    force, steps = _active_set(flexibility, 1.0 - 0.5 * r**2)
    closed = force > 0.0
    return FoundContact(
        rescaled_load=depth * size * math.fsum(force),
        contact_radius=size * math.sqrt(2.5 * math.fsum(force * r**2) / math.fsum(force)),
        last_radius=size * float(r[closed].max()),
        steps=steps,
    )


def _active_set(flexibility: FloatArray, wanted: FloatArray) -> tuple[FloatArray, int]:
    """Forces >= 0 with ``flexibility force >= wanted`` and equality where there is force."""
    active = wanted > 0.0
    for step in range(1, STEPS + 1):
        force = np.zeros(len(wanted))
        force[active] = np.linalg.solve(flexibility[np.ix_(active, active)], wanted[active])
        overlap = wanted - flexibility @ force
        # Active nodes have no overlap but rounding: they stay closed while they press.
        following = np.where(active, force > 0.0, overlap > 0.0)
        if (following == active).all():
            return force, step
        active = following
    raise NotConverged(f"the active set still changes after {STEPS} steps")


def _flexibility(mesh: MeshQuad, nu: float) -> tuple[FloatArray, FloatArray]:
    """Radii of the surface nodes that may touch, and displacement there per unit force on each ring."""
    displacement = Basis(mesh, ElementVector(ElementQuad2()), intorder=5)
    pressure = displacement.with_element(ElementQuad1())
    matrix = _matrix(displacement, pressure, nu)
    names = displacement.get_dofs(["axis", "base"]).all(["u^1"]), displacement.get_dofs("base").all(["u^2"])
    free = np.setdiff1d(np.arange(matrix.shape[0]), np.concatenate(names))
    touch: IntArray = displacement.get_dofs("contact").all(["u^2"])
    unit = np.zeros((matrix.shape[0], len(touch)))
    # Positive forces press down, along depth; a ring's force is 2 pi times its share per radian.
    unit[touch, np.arange(len(touch))] = 1.0 / (2.0 * math.pi)
    solved = solve(matrix[free][:, free].tocsc(), unit[free], THRESHOLD)
    if solved.status is LinearStatus.NOT_CONVERGED:
        raise NotConverged(f"the linear system keeps a residual of {solved.residual:.1e}", solved)
    return displacement.doflocs[0, touch], solved.value[np.searchsorted(free, touch)]


def _matrix(displacement: Basis, pressure: Basis, nu: float) -> csc_matrix:
    """Mixed stiffness in scikit-fem's forms, composite modulus 1, per radian."""
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
        format="csc",
    )
