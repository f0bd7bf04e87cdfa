"""Meshes of the reference planes: rectangles with named boundaries.

The boundaries are `contact`, `free`, `axis`, `base` and, if the body has a side, `wall`.
"""

from __future__ import annotations

import math

import numpy as np
from skfem import MeshQuad

from metafem._validate import FloatArray

# Elements of the oblate-spheroidal plane. The fields of a contact are low harmonics of phi: two intervals are
# enough. They decay as exp(-mu): elements of length 2 to 4 resolve this. The far end is fixed, 5e12 contact
# radii away.
HALF_SPACE_PHI = (0.0, 0.25 * math.pi, 0.5 * math.pi)
HALF_SPACE_MU = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 15.0, 18.0, 22.0, 26.0, 30.0)

# Ratios of the distances of neighbouring lines from an edge: up to a tenth of the radius, and beyond it. A
# square root is smooth in the logarithm of the distance, and its contribution decreases with the distance.
# Beyond a tenth, the fields have an error of at most 1e-4 with degree 6.
EDGE_RATIO, RATIO, EDGE_REACH = 6.0, 2.0, 0.1

# Size of the last elements at the contact's edge and at the cap's foot, in units of their radii. The
# bracket of the indentation is proportional to the first.
CONTACT_EDGE = 1e-5
FOOT_EDGE = 1e-3


def half_space_mesh() -> MeshQuad:
    """Return the mesh of the oblate-spheroidal plane (phi, mu) of a half-space."""
    mesh = MeshQuad.init_tensor(np.array(HALF_SPACE_PHI), np.array(HALF_SPACE_MU))
    return mesh.with_boundaries(
        {
            "contact": lambda x: x[1] == 0.0,
            "free": lambda x: x[0] == 0.0,
            "axis": lambda x: x[0] == HALF_SPACE_PHI[-1],
            "base": lambda x: x[1] == HALF_SPACE_MU[-1],
        }
    )


def graded_mesh(
    contact: float,
    outer: float,
    thickness: float,
    foot: float | None = None,
    *,
    contact_edge: float = CONTACT_EDGE,
    foot_edge: float = FOOT_EDGE,
) -> MeshQuad:
    """Return a mesh of a body's plane (s, depth), graded to the contact's edge and the cap's foot.

    The plane coordinates of the contact's edge, the side and the foot, and the thickness, are in mm. The last
    elements have the sizes `contact_edge` and `foot_edge`, relative to the radii of the contact and of the
    foot.
    """
    fine, reach = contact_edge * contact, EDGE_REACH * contact
    across = [_graded(contact, 0.0, fine, reach)[::-1]]
    if foot is None:
        across.append(_graded(contact, outer, fine, reach, thickness))
    else:
        coarse, wide, middle = foot_edge * foot, EDGE_REACH * foot, 0.5 * (contact + foot)
        across += [
            _graded(contact, middle, fine, reach),
            _graded(foot, middle, coarse, wide)[::-1],
            _graded(foot, outer, coarse, wide, thickness),
        ]
    s = np.concatenate([across[0], *(part[1:] for part in across[1:])])
    mesh = MeshQuad.init_tensor(s, _graded(0.0, thickness, fine, reach))
    return named(mesh, contact, outer, thickness)


def uniform_mesh(cell: float, reach: float, outer: float, growth: float = 1.3) -> MeshQuad:
    """Return a plane with equal cells up to r = reach; beyond and below, cells grow."""
    count = round(reach / cell)
    near = cell * np.arange(count + 1)
    size = cell * growth ** np.arange(1, 1 + math.ceil(math.log(1.0 + outer / cell) / math.log(growth)))
    s = np.concatenate([near, near[-1] + np.cumsum(size)])
    depth = np.concatenate([[0.0, cell], cell + np.cumsum(size)])
    return named(MeshQuad.init_tensor(s, depth), near[-1], s[-1], depth[-1])


def named(mesh: MeshQuad, contact: float, outer: float, thickness: float) -> MeshQuad:
    """Return the mesh with named boundaries."""
    return mesh.with_boundaries(
        {
            "contact": lambda x: (x[1] == 0.0) & (x[0] < contact),
            "free": lambda x: (x[1] == 0.0) & (x[0] > contact),
            "axis": lambda x: x[0] == 0.0,
            "base": lambda x: x[1] == thickness,
            "wall": lambda x: x[0] == outer,
        }
    )


def _graded(
    fine_end: float, coarse_end: float, smallest: float, edge: float, largest: float = math.inf
) -> FloatArray:
    """Return points from the fine end to the coarse end, with a first interval of at most `smallest`.

    Distances grow by EDGE_RATIO up to `edge`, and beyond it by RATIO or by `largest`.
    """
    distance = [smallest]
    while distance[-1] < abs(coarse_end - fine_end):
        x = distance[-1]
        distance.append(x * EDGE_RATIO if x < edge else min(x * RATIO, x + largest))
    points = fine_end + (coarse_end - fine_end) * np.append(0.0, distance) / distance[-1]
    points[-1] = coarse_end
    return points
