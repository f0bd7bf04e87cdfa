"""Closed meshes of the part, a block with caps, and of its mould, a plate with cavities.

A mesh is a pair: vertices (n, 3) [mm], and triangles (m, 3), counterclockwise, seen from outside.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.caps import SPHERE, Cap
from metafem.errors import refuse_if
from metafem.surface import Block, Surface

# Triangles of the sides and the bottom of the block. Corners 0 to 3 are those of the top face,
# counterclockwise, and corners 4 to 7 lie below them.
_BOX = np.array(
    [face for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)) for face in ((i, 4 + i, j), (j, 4 + i, 4 + j))]
    + [(4, 6, 5), (4, 7, 6)]
)
_CORNERS = 8

# Least number of rings: with one ring a cap would be a pyramid.
_FEWEST = 2

Mesh = tuple[FloatArray, IntArray]


def mirrored(points: FloatArray) -> FloatArray:
    """Return points of the part as seen from the open face of the mould, x -> -x [mm], (n, 2) or (n, 3).

    The part lies face down on the mould, so that its left and right are exchanged.
    """
    result = np.array(points)
    result[:, 0] = 0.0 - result[:, 0]  # not -x, which would be -0.0 on the axis
    return result


def block_mesh(surface: Surface, block: Block, chord_error: float) -> Mesh:
    """Return the mesh of the part: a block with caps, and its base plane at z = 0.

    The base circles of the caps must not overlap and must lie within the block. The chord error is the
    largest depth of a face below its cap [mm].

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface([[0, 0]], [0.1], 0.5, mf.Material(1.36))
    >>> vertices, faces = block_mesh(surface, mf.Block(2, 2, 1), 1e-3)
    >>> round(float(vertices[:, 2].max()), 12)
    0.1
    """
    x, y = 0.5 * block.width, 0.5 * block.length
    corners = [(-x, -y), (x, -y), (x, y), (-x, y)]
    vertices = [np.array([(*corner, z) for z in (0.0, -block.thickness) for corner in corners])]
    faces, rims, count = [_BOX], [np.arange(4)], _CORNERS
    rings = ring_count(surface.height, surface.radius, chord_error, surface.cap)
    for i, number in enumerate(rings.tolist()):
        cap = cap_vertices(surface.height[i], surface.radius[i], number, surface.cap.one(i))
        vertices.append(cap + np.append(surface.position[i], 0.0))
        faces.append(count + cap_faces(number))
        count += len(cap)
        rims.append(np.arange(count - 6 * number, count))
    points, plane = np.vstack(vertices), np.concatenate(rims)
    # The face between the caps: no other point lies in the circle of a rim, so that its polygon is a union
    # of Delaunay triangles, those that have all corners on one rim.
    flat = _triangles(points[plane, :2])
    rim = np.repeat(np.arange(4 + len(rings)), [1, 1, 1, 1, *6 * rings])[flat]
    triangles = np.vstack([*faces, plane[flat[(rim[:, :1] != rim[:, 1:]).any(axis=1)]]])
    refuse_if(not _closed(triangles, count), "the mesh of the part is not closed; it cannot be written")
    return points, triangles


def mould_mesh(part: Mesh, surface: Surface, block: Block) -> Mesh:
    """Return the mesh of the mould: a plate with the block's outline and a cavity for each cap.

    Its open face is z = 0; seen from there, the mould is the mirror image of the part. The plate is as thick
    as the block plus the deepest cavity.
    """
    vertices = part[0].copy()
    vertices[4:_CORNERS, 2] = block.thickness + float(surface.height.max())
    # the caps point down, and the order of corners is reversed because inside and outside are exchanged
    return mirrored(vertices) * (1.0, 1.0, -1.0), part[1][:, ::-1]


def _closed(faces: IntArray, count: int) -> bool:
    """Return whether two faces share each edge and traverse it in opposite directions."""
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    forth, back = np.sort(start * count + end), np.sort(end * count + start)
    return bool((forth == back).all() and (forth[1:] > forth[:-1]).all())


def _triangles(points: FloatArray) -> IntArray:
    """Return the Delaunay triangulation (m, 3) of points (n, 2), counterclockwise."""
    from scipy.spatial import Delaunay

    triangles = Delaunay(points).simplices
    a, b, c = (points[triangles[:, k]] for k in range(3))
    (ux, uy), (vx, vy) = (b - a).T, (c - a).T
    result: IntArray = np.where((ux * vy < uy * vx)[:, None], triangles[:, ::-1], triangles)
    return result


def ring_count(height: FloatArray, radius: FloatArray, chord_error: float, cap: Cap = SPHERE) -> IntArray:
    """Return the number of rings of each cap, (n,), with which its faces keep the chord error [mm]."""
    return np.maximum(_FEWEST, np.ceil(cap.ring_count(height, radius, chord_error))).astype(np.int64)


def cap_vertices(height: float, radius: float, rings: int, cap: Cap = SPHERE) -> FloatArray:
    """Return the vertices of a cap with its summit above the origin [mm], (m, 3).

    The vertices are the summit and rings of 6, 12, 18, ... points, at equal distances along the meridian from
    the summit to the base plane z = 0. The last ``6 rings`` vertices are the rim, counterclockwise.
    """
    ring, turn = _rings(rings)
    across, z = (each[0, ring] for each in cap.rings(np.array([height]), np.array([radius]), rings))
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), z])


@cache
def cap_faces(rings: int) -> IntArray:
    """Return the outward faces of a cap, (6 rings^2, 3): those of a disc with rings of equal distances."""
    ring, turn = _rings(rings)
    result = _triangles(np.column_stack([ring * np.cos(turn), ring * np.sin(turn)]))
    result.flags.writeable = False
    return result


def _rings(count: int) -> tuple[IntArray, FloatArray]:
    """Return the ring and the angle [rad] of each vertex of a cap."""
    size = np.maximum(6 * np.arange(count + 1), 1)
    ring = np.repeat(np.arange(count + 1), size)
    first = np.cumsum(size) - size
    return ring, 2.0 * math.pi * (np.arange(len(ring)) - first[ring]) / size[ring]
