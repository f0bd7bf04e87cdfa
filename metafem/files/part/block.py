"""The part as a closed mesh: spherical caps on a block."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, MetafemError
from metafem.files.part.cap import CHORD_ERROR, cap_mesh
from metafem.surface import Block, Surface

__all__ = ["alignment_asperities", "alignment_positions", "block_mesh", "stl_bytes"]

# Sides and bottom of the block: its corners 0 to 3 at the top, 4 to 7 below them, counterclockwise.
_BOX = np.array(
    [face for i, j in ((0, 1), (1, 2), (2, 3), (3, 0)) for face in ((i, 4 + i, j), (j, 4 + i, 4 + j))]
    + [(4, 6, 5), (4, 7, 6)]
)

# Rounding of positions of some 10 mm to the 24 bits of an STL file, relative.
_SINGLE = float(np.finfo(np.float32).eps)


def alignment_positions(template: Surface) -> FloatArray:
    """Return places of four alignment asperities, (4, 2) [mm].

    One lattice pitch outside the corners of the template, along x and along y; the pitch is the
    smallest distance between two of its sites.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.1, (8, 8), 1.5, radius=0.5, material=mf.Material(1.36))
    >>> alignment_positions(template)[-1]
    array([6.75, 6.75])
    """
    from scipy.spatial import KDTree

    if template.count < 2:
        raise InvalidInput("alignment asperities need a template of at least two sites, for its pitch")
    distance, _ = KDTree(template.position).query(template.position, k=2)
    pitch = float(distance[:, 1].min())
    (west, south), (east, north) = (
        template.position.min(axis=0) - pitch,
        template.position.max(axis=0) + pitch,
    )
    return np.array([(west, south), (east, south), (west, north), (east, north)])


def alignment_asperities(surface: Surface, template: Surface, height: float) -> Surface:
    """Return the four alignment asperities as a surface of their own.

    Their radius is the smallest in use that is no less than their height: the part needs no further tool,
    and no other of its tools makes narrower caps of that height.

    Raises
    ------
    InvalidInput
        If `height` [mm] does not exceed the tallest summit, or exceeds the largest radius in use.
    """
    tallest = float(surface.height.max())
    top = check.number("part.alignment_height", height)
    if top <= tallest:
        raise InvalidInput(
            f"part.alignment_height = {top:g} mm must exceed the tallest summit, {tallest:g} mm, "
            "so that the alignment asperities touch first"
        )
    largest = float(surface.radius.max())
    if top > largest:
        raise InvalidInput(
            f"part.alignment_height = {top:g} mm exceeds the largest radius in use, {largest:g} mm; a cap is "
            "at most as high as its radius"
        )
    radius = float(surface.radius[surface.radius >= top].min())
    return surface.replaced(
        position=alignment_positions(template), height=np.full(4, top), radius=np.full(4, radius)
    )


def block_mesh(
    surface: Surface, alignment_height: float | None = None, template: Surface | None = None
) -> Any:
    """Mesh the part: true spherical caps on the block, the base plane at z = 0.

    Parameters
    ----------
    surface : Surface
        With a block; ``0 < h <= R``, and caps of base radius ``sqrt(2 R h - h^2)`` that neither
        overlap nor leave the block.
    alignment_height : float, optional
        Height of four alignment asperities [mm].
    template : Surface, optional
        Whose corners carry them; `surface` unless told.

    Returns
    -------
    trimesh.Trimesh
        Watertight; the vertices of a cap lie on its sphere, its faces at most 4e-4 R below.

    Raises
    ------
    InvalidInput
        For a surface without a block and caps that cannot be made; names the asperity.

    Examples
    --------
    >>> import metafem as mf
    >>> surface = mf.Surface([[0, 0]], [0.1], 0.5, mf.Material(1.36), block=mf.Block(2, 2, 1))
    >>> mesh = block_mesh(surface)
    >>> mesh.is_watertight, round(float(mesh.bounds[1, 2]), 12)
    (True, 0.1)
    """
    if surface.block is None:
        raise InvalidInput(
            "the surface has no block; a part needs block=metafem.Block(width, length, thickness)"
        )
    position, height, radius = surface.position, surface.height, surface.radius
    if alignment_height is not None:
        extra = alignment_asperities(surface, template or surface, alignment_height)
        position = np.vstack([position, extra.position])
        height = np.concatenate([height, extra.height])
        radius = np.concatenate([radius, extra.radius])
    whole = surface.replaced(position=position, height=height, radius=radius)
    _refuse_impossible(whole, surface.block, surface.count)
    mesh = _welded(whole, surface.block)
    _certify(mesh, whole, surface.block)
    return mesh


def stl_bytes(mesh: Any) -> bytes:
    """Return a mesh as binary STL."""
    return bytes(mesh.export(file_type="stl"))


def _refuse_impossible(surface: Surface, block: Block, asperities: int) -> None:
    """Refuse caps that are no caps, overlap or leave the block; alignment asperities come last."""
    from scipy.spatial import KDTree

    def name(i: int) -> str:
        x, y = surface.position[i]
        where = f"at ({x:g}, {y:g}) mm"
        if i < asperities:
            return f"asperity {i} {where}"
        return f"alignment asperity {i - asperities} {where} (part.alignment_height)"

    h, R = surface.height, surface.radius
    for i in np.flatnonzero((h <= 0.0) | (h > R))[:1]:
        raise InvalidInput(
            f"{name(i)} has the height {h[i]:g} mm; a cap of radius {R[i]:g} mm needs a height above 0 "
            "and at most its radius"
        )
    base = np.sqrt(h * (2.0 * R - h))
    room = 0.5 * np.array([block.width, block.length])
    for i in np.flatnonzero((np.abs(surface.position) + base[:, None] >= room).any(axis=1))[:1]:
        raise InvalidInput(
            f"{name(i)} has a cap of base radius {base[i]:g} mm, which leaves the block of "
            f"{2 * room[0]:g} by {2 * room[1]:g} mm; make the block larger or the lattice smaller"
        )
    pairs = KDTree(surface.position).query_pairs(2.0 * float(base.max()), output_type="ndarray")
    distance = np.linalg.norm(np.diff(surface.position[pairs], axis=1)[:, 0], axis=1)
    for i, j in pairs[distance <= base[pairs].sum(axis=1)][:1]:
        raise InvalidInput(
            f"{name(i)} and {name(j)} overlap: their caps have base radii of {base[i]:g} and {base[j]:g} mm; "
            "increase the pitch or lower the summits"
        )


def _welded(surface: Surface, block: Block) -> Any:
    """Return the caps on a base plane that is triangulated between their rims, and the block below."""
    import trimesh
    from manifold3d import triangulate

    x, y = 0.5 * block.width, 0.5 * block.length
    corners = np.array([(-x, -y), (x, -y), (x, y), (-x, y)])
    top, bottom = (np.column_stack([corners, np.full(4, z)]) for z in (0.0, -block.thickness))
    vertices, faces, outlines = [top, bottom], [_BOX], [np.arange(4)]
    count = 8
    for place, h, R in zip(surface.position, surface.height, surface.radius, strict=True):
        points, triangles, rim = cap_mesh(float(h), float(R))
        points[:, :2] += place
        vertices.append(points)
        faces.append(count + triangles)
        outlines.append(count + rim[::-1])  # a hole: clockwise
        count += len(points)
    every = np.vstack(vertices)
    plane = triangulate([every[outline, :2] for outline in outlines])
    faces.append(np.concatenate(outlines)[plane])
    return trimesh.Trimesh(every, np.vstack(faces), process=False)


def _certify(mesh: Any, surface: Surface, block: Block) -> None:
    """Check the mesh against closed forms; a fault is the program's, not the user's."""
    h, R = surface.height, surface.radius
    caps = math.pi * h**2 * (3.0 * R - h) / 3.0
    exact = block.width * block.length * block.thickness + math.fsum(caps)
    shell = CHORD_ERROR * math.fsum(2.0 * math.pi * R**2 * h)  # chord error times the caps' area
    tallest = float(h.max())
    findings = {
        "is not closed": not mesh.is_watertight,
        "has faces that look inwards": not mesh.is_winding_consistent,
        "misses the caps' volume": not -shell - _SINGLE * exact <= _volume(mesh) - exact <= _SINGLE * exact,
        "misses the tallest summit": abs(float(mesh.bounds[1, 2]) - tallest) > _SINGLE * tallest,
    }
    for fault, found in findings.items():
        if found:
            raise MetafemError(f"the mesh of the part {fault}; the part file was not written")


def _volume(mesh: Any) -> float:
    """Volume by the divergence theorem, the sum of ``(a, b, c)/6`` over the faces [mm^3]."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6.0
