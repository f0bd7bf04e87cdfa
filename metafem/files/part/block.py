"""The part and its mould as closed meshes: caps on a block, or cavities in a plate."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact.cap_geometry import SPHERES, CapShape
from metafem.errors import MetafemError
from metafem.surface import Block, Surface

# Sides and bottom of the block: its corners 0 to 3 at the top, 4 to 7 below them, counterclockwise.
_BOX = np.array(
    [face for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)) for face in ((i, 4 + i, j), (j, 4 + i, 4 + j))]
    + [(4, 6, 5), (4, 7, 6)]
)
_CORNERS = 8

# One ring would make a pyramid of the flattest caps.
_FEWEST = 2

# Number of faces that are processed at a time: about ten megabytes.
_AT_A_TIME = 1 << 16


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that bound a solid."""

    vertices: FloatArray  # (n, 3) [mm]
    faces: IntArray  # (m, 3), counterclockwise, seen from outside

    def corners(self) -> Iterator[FloatArray]:
        """Yield the corners of faces, (k, 3 corners, 3) [mm], some at a time."""
        for start in range(0, len(self.faces), _AT_A_TIME):
            yield self.vertices[self.faces[start : start + _AT_A_TIME]]

    @property
    def closed(self) -> bool:
        """Whether each edge belongs to two faces that traverse it in opposite directions."""
        start, end = self.faces.ravel(), np.roll(self.faces, -1, axis=1).ravel()
        forth = np.sort(start * len(self.vertices) + end)
        back = np.sort(end * len(self.vertices) + start)
        return bool((forth == back).all() and (forth[1:] > forth[:-1]).all() and (start != end).all())


def mirrored(points: FloatArray) -> FloatArray:
    """Return points of the part (n, 2) or (n, 3) as seen from the open face of the mould: x -> -x [mm].

    The part lies face down on the mould, as on a page that is turned over.
    """
    result = np.array(points)
    result[:, 0] = 0.0 - result[:, 0]  # -x is -0.0 on the axis
    return result


def block_mesh(surface: Surface, block: Block, chord_error: float, shape: CapShape = SPHERES) -> Mesh:
    """Mesh the part: caps of a shape on the block, the base plane at z = 0.

    The base circles of the caps must not overlap or leave the block. The chord error is the largest depth of
    a face below its cap [mm].

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface([[0, 0]], [0.1], 0.5, mf.Material(1.36))
    >>> mesh = block_mesh(surface, mf.Block(2, 2, 1), 1e-3)
    >>> mesh.closed, round(float(mesh.vertices[:, 2].max()), 12)
    (True, 0.1)
    """
    mesh = _welded(surface, block, chord_error, shape)
    if not mesh.closed:
        raise MetafemError("the mesh of the part is not closed; the part files were not written")
    return mesh


def mould_mesh(part: Mesh, surface: Surface, block: Block) -> Mesh:
    """Return the negative of a part's mesh: a plate with the block's outline and a cavity for each cap.

    It is seen from its open face, z = 0, as the mirror image of the part. Below the deepest cavity the
    plate is as thick as the block.
    """
    vertices = part.vertices.copy()
    vertices[4:_CORNERS, 2] = block.thickness + float(surface.height.max())
    # summits point down, and inside and outside are exchanged
    return Mesh(mirrored(vertices) * (1.0, 1.0, -1.0), part.faces[:, ::-1])


def triangle_count(
    height: FloatArray, radius: FloatArray, chord_error: float, shape: CapShape = SPHERES
) -> int:
    """Return the number of faces of a part or its mould, without computing them.

    A plane of V vertices with n holes has ``V + 2 n - 2`` triangles.
    """
    rings = ring_count(height, radius, chord_error, shape)
    plane = 4 + 6 * rings.sum() + 2 * len(rings) - 2
    return int(6 * (rings**2).sum() + plane + len(_BOX))


def _welded(surface: Surface, block: Block, chord_error: float, shape: CapShape) -> Mesh:
    """Return the caps on a base plane that is triangulated between their rims, and the block below."""
    x, y = 0.5 * block.width, 0.5 * block.length
    corners = np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
    vertices = [np.column_stack([corners, np.full(4, z)]) for z in (0.0, -block.thickness)]
    faces, outline, points = [_BOX], [np.arange(4)], [1, 1, 1, 1]
    count = _CORNERS
    every = ring_count(surface.height, surface.radius, chord_error, shape)
    for rings in np.unique(every).tolist():
        which = np.flatnonzero(every == rings)
        caps = cap_vertices(surface.height[which], surface.radius[which], rings, shape)
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
    """Triangulate a plane between rims; `owner` (n,) is the number of the rim of each point.

    It is the Delaunay triangulation without the triangles that have all corners on one rim. There are no
    other points within the circle of a rim, so that its polygon is a union of Delaunay triangles.
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


def ring_count(
    height: FloatArray, radius: FloatArray, chord_error: float, shape: CapShape = SPHERES
) -> IntArray:
    """Return numbers of rings (n,) that keep triangles within the chord error [mm] of the caps."""
    return np.maximum(_FEWEST, np.ceil(shape.ring_count(height, radius, chord_error))).astype(np.int64)


def cap_vertices(height: FloatArray, radius: FloatArray, rings: int, shape: CapShape = SPHERES) -> FloatArray:
    """Return vertices (n, m, 3) [mm] of caps with their summits above the origin.

    The summit and rings of 6, 12, 18, ... points lie on the cap, at equal distances along the meridian down
    to the base plane z = 0. The last ring is the rim: the last ``6 rings`` points, counterclockwise.
    """
    size = np.arange(rings + 1) * 6
    size[0] = 1
    ring = np.repeat(np.arange(rings + 1), size)
    place = np.arange(len(ring)) - np.repeat(np.cumsum(size) - size, size)
    turn = 2.0 * math.pi * place / size[ring]
    across, z = shape.rings(height, radius, rings)
    return np.stack([across[:, ring] * np.cos(turn), across[:, ring] * np.sin(turn), z[:, ring]], axis=2)


@cache
def cap_faces(rings: int) -> IntArray:
    """Return outward faces (6 rings^2, 3): six sectors of triangles between neighbouring rings."""
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
