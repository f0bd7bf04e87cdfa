"""The part and its mould as closed meshes: caps on a block, or cavities in a plate."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact.cap_geometry import SPHERES, CapShape
from metafem.errors import MetafemError
from metafem.files.part.cap import cap_faces, cap_vertices, ring_count
from metafem.files.part.mesh import Mesh, mirrored
from metafem.surface import Block, Surface

# Sides and bottom of the block: its corners 0 to 3 at the top, 4 to 7 below them, counterclockwise.
_BOX = np.array(
    [face for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)) for face in ((i, 4 + i, j), (j, 4 + i, 4 + j))]
    + [(4, 6, 5), (4, 7, 6)]
)
_CORNERS = 8

# Relative rounding error of positions of about 10 mm in the 24 bits of an STL file.
_SINGLE = float(np.finfo(np.float32).eps)


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
    box = block.width * block.length * block.thickness
    _certify(mesh, "part", surface, box, 1.0, chord_error, shape)
    return mesh


def mould_mesh(
    part: Mesh, surface: Surface, block: Block, chord_error: float, shape: CapShape = SPHERES
) -> Mesh:
    """Return the negative of a part's mesh: a plate with the block's outline and a cavity for each cap.

    It is seen from its open face, z = 0, as the mirror image of the part. Below the deepest cavity the
    plate is as thick as the block.
    """
    tallest = float(surface.height.max())
    vertices = part.vertices.copy()
    vertices[4:_CORNERS, 2] = block.thickness + tallest
    # summits point down, and inside and outside are exchanged
    mesh = Mesh(mirrored(vertices) * (1.0, 1.0, -1.0), part.faces[:, ::-1])
    plate = block.width * block.length * (block.thickness + tallest)
    _certify(mesh, "mould", surface, plate, -1.0, chord_error, shape)
    return mesh


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


def _certify(
    mesh: Mesh,
    what: str,
    surface: Surface,
    box: float,
    sign: float,
    chord_error: float,
    shape: CapShape,
) -> None:
    """Check the mesh against closed forms; an error here is a fault of the program."""
    h, R = surface.height, surface.radius
    caps = math.fsum(shape.volume(h, R))
    exact = box + sign * caps
    shell = chord_error * math.fsum(shape.largest_area(h, R))
    lost = sign * (exact - mesh.volume)
    tallest = float(h.max())
    top = float((sign * mesh.vertices[_CORNERS:, 2]).max())
    # faces lie below spheres, but above a profile that curves the other way
    gained = 0.0 if shape is SPHERES else shell
    if not -gained - _SINGLE * exact <= lost <= shell + _SINGLE * exact:
        raise MetafemError(f"the mesh of the {what} misses the caps' volume; the part files were not written")
    if abs(top - tallest) > _SINGLE * tallest:
        raise MetafemError(
            f"the mesh of the {what} misses the tallest summit; the part files were not written"
        )
