"""Meshes of the reference planes, which are rectangles with named boundaries.

The boundaries are `contact`, `free`, `axis`, `base` and, if the body has a side, `wall`.
"""

from __future__ import annotations

import math

import numpy as np
from skfem import MeshQuad

from metafem._validate import FloatArray

# Vertices of the mesh of the oblate-spheroidal plane. In phi the fields of a contact are low harmonics, so
# two intervals are enough. In mu they decay as exp(-mu), which elements of length 2 to 4 resolve far away.
# The end at mu = 30 is 5e12 contact radii away and is fixed.
HALF_SPACE_PHI = (0.0, 0.25 * math.pi, 0.5 * math.pi)
HALF_SPACE_MU = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 15.0, 18.0, 22.0, 26.0, 30.0)

# Ratios of the distances of neighbouring lines from an edge: EDGE_RATIO up to a tenth of the radius, and
# RATIO farther away. Steep grading is possible at the edge, because a square root is smooth in the logarithm
# of the distance and the innermost elements contribute little. Beyond a tenth of the radius, the fields have
# an error of at most 1e-4 with degree 6.
EDGE_RATIO, RATIO, EDGE_REACH = 6.0, 2.0, 0.1

# Sizes of the smallest elements at the contact's edge and at the cap's foot, over the radii of contact and
# foot. The bracket of the indentation is proportional to the size at the edge.
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
    """Return a mesh of a body's plane (s, depth), graded towards the contact's edge and the cap's foot.

    `contact`, `outer` and `foot` are the plane coordinates of the contact's edge, the side and the foot [mm];
    the thickness is also in mm. `contact_edge` and `foot_edge` are the sizes of the smallest elements, over
    the radii of contact and foot.
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
    """Return a mesh with equal cells up to r = reach; outside and below this region the cells grow."""
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
    """Return points from the fine end to the coarse end; the first interval is at most `smallest`.

    The distances of the points from the fine end grow by EDGE_RATIO up to `edge`. Beyond it they grow by
    RATIO, but by no more than `largest`.
    """
    distance = [smallest]
    while distance[-1] < abs(coarse_end - fine_end):
        x = distance[-1]
        distance.append(x * EDGE_RATIO if x < edge else min(x * RATIO, x + largest))
    points = fine_end + (coarse_end - fine_end) * np.append(0.0, distance) / distance[-1]
    points[-1] = coarse_end
    return points
