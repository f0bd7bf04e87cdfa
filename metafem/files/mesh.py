"""Closed meshes of the part, a block with caps, and of its mould, a plate with cavities."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.caps import SPHERE, Cap
from metafem.errors import MetafemError
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


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that bound a solid."""

    vertices: FloatArray  # (n, 3) [mm]
    faces: IntArray  # (m, 3), counterclockwise, seen from outside

    @property
    def closed(self) -> bool:
        """Whether two faces share each edge and traverse it in opposite directions."""
        start, end = self.faces.ravel(), np.roll(self.faces, -1, axis=1).ravel()
        forth = np.sort(start * len(self.vertices) + end)
        back = np.sort(end * len(self.vertices) + start)
        return bool((forth == back).all() and (forth[1:] > forth[:-1]).all() and (start != end).all())


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
    >>> mesh = block_mesh(surface, mf.Block(2, 2, 1), 1e-3)
    >>> mesh.closed, round(float(mesh.vertices[:, 2].max()), 12)
    (True, 0.1)
    """
    mesh = _welded(surface, block, chord_error)
    if not mesh.closed:
        raise MetafemError("the mesh of the part is not closed; the part files were not written")
    return mesh


def mould_mesh(part: Mesh, surface: Surface, block: Block) -> Mesh:
    """Return the mesh of the mould: a plate with the block's outline and a cavity for each cap.

    Its open face is z = 0; seen from there, the mould is the mirror image of the part. The plate is as thick
    as the block plus the deepest cavity.
    """
    vertices = part.vertices.copy()
    vertices[4:_CORNERS, 2] = block.thickness + float(surface.height.max())
    # the caps point down, and the order of corners is reversed because inside and outside are exchanged
    return Mesh(mirrored(vertices) * (1.0, 1.0, -1.0), part.faces[:, ::-1])


def triangle_count(height: FloatArray, radius: FloatArray, chord_error: float, cap: Cap = SPHERE) -> int:
    """Return the number of triangles of a part, which is also that of its mould, without meshing it.

    A triangulated plane with V vertices and n holes has ``V + 2 n - 2`` triangles.
    """
    rings = ring_count(height, radius, chord_error, cap)
    plane = 4 + 6 * rings.sum() + 2 * len(rings) - 2
    return int(6 * (rings**2).sum() + plane + len(_BOX))


def _welded(surface: Surface, block: Block, chord_error: float) -> Mesh:
    """Return one mesh of the caps, the base plane between their rims, and the block below."""
    x, y = 0.5 * block.width, 0.5 * block.length
    corners = np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
    vertices = [np.column_stack([corners, np.full(4, z)]) for z in (0.0, -block.thickness)]
    faces, outline, points = [_BOX], [np.arange(4)], [1, 1, 1, 1]
    count = _CORNERS
    every = ring_count(surface.height, surface.radius, chord_error, surface.cap)
    for rings in np.unique(every).tolist():
        which = np.flatnonzero(every == rings)
        caps = cap_vertices(surface.height[which], surface.radius[which], rings, surface.cap.at(which))
        caps[:, :, :2] += surface.position[which, None]
        size = caps.shape[1]
        first = count + size * np.arange(len(which))
        faces.append((first[:, None, None] + cap_faces(rings)).reshape(-1, 3))
        outline.append((first[:, None] + np.arange(size - 6 * rings, size)).ravel())
        points += [6 * rings] * len(which)
        vertices.append(caps.reshape(-1, 3))
        count += size * len(which)
    result, plane = np.vstack(vertices), np.concatenate(outline)
    faces.append(plane[_plane(result[plane, :2], np.repeat(np.arange(len(points)), points))])
    return Mesh(result, np.vstack(faces))


def _plane(points: FloatArray, owner: IntArray) -> IntArray:
    """Return the triangles (m, 3) of the plane between the rims of the caps and the block's outline.

    `owner` (n,) is the number of the rim on which each point lies; each corner of the outline has a number of
    its own. The result is the Delaunay triangulation without the triangles that have all corners on one rim.
    No other points lie within the circle of a rim, so that its polygon is a union of Delaunay triangles.
    """
    from scipy.spatial import Delaunay

    triangles = Delaunay(points).simplices
    rim = owner[triangles]
    between = triangles[(rim[:, :1] != rim[:, 1:]).any(axis=1)]
    a, b, c = (points[between[:, k]] for k in range(3))
    u, v = b - a, c - a
    clockwise = u[:, 0] * v[:, 1] < u[:, 1] * v[:, 0]
    outward: IntArray = np.where(clockwise[:, None], between[:, ::-1], between)
    return outward


def ring_count(height: FloatArray, radius: FloatArray, chord_error: float, cap: Cap = SPHERE) -> IntArray:
    """Return the number of rings of each cap, (n,), with which its faces keep the chord error [mm]."""
    return np.maximum(_FEWEST, np.ceil(cap.ring_count(height, radius, chord_error))).astype(np.int64)


def cap_vertices(height: FloatArray, radius: FloatArray, rings: int, cap: Cap = SPHERE) -> FloatArray:
    """Return the vertices of caps with their summits above the origin [mm], (n, m, 3).

    The vertices are the summit and rings of 6, 12, 18, ... points, at equal distances along the meridian from
    the summit to the base plane z = 0. The last ``6 rings`` vertices are the rim, counterclockwise.
    """
    size = np.arange(rings + 1) * 6
    size[0] = 1
    ring = np.repeat(np.arange(rings + 1), size)
    place = np.arange(len(ring)) - np.repeat(np.cumsum(size) - size, size)
    turn = 2.0 * math.pi * place / size[ring]
    across, z = cap.rings(height, radius, rings)
    return np.stack([across[:, ring] * np.cos(turn), across[:, ring] * np.sin(turn), z[:, ring]], axis=2)


@cache
def cap_faces(rings: int) -> IntArray:
    """Return the outward faces of a cap, (6 rings^2, 3); neighbouring rings are joined in six sectors."""
    faces: list[tuple[int, int, int]] = []

    def point(ring: int, place: int) -> int:
        return 1 + 3 * ring * (ring - 1) + place % (6 * ring) if ring else 0

    for ring in range(rings):
        for sector in range(6):
            inner, outer = sector * ring, sector * (ring + 1)
            for j in range(ring + 1):
                here, corner = point(ring, inner + j), point(ring + 1, outer + j + 1)
                faces.append((here, point(ring + 1, outer + j), corner))
                if j < ring:
                    faces.append((here, corner, point(ring, inner + j + 1)))
    result = np.array(faces, dtype=np.int64)
    result.flags.writeable = False
    return result
