"""The files of a part: its alignment asperities, checks, closed meshes, table of holes and drilling program.

A mesh is a pair: vertices (n, 3) [mm], and triangles (m, 3), counterclockwise, seen from outside.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem._values import MICROMETRES
from metafem.caps import SPHERE, Cap, Caps
from metafem.errors import InvalidInput, refuse_if
from metafem.files.summits import caps_column, csv
from metafem.inversion import Design
from metafem.notes import Note, information
from metafem.progress import doing
from metafem.surface import Block, Surface

if TYPE_CHECKING:
    from metafem.files.specification.sections import PartSection

# Default chord error as a fraction of the smallest radius. For the source paper's radius of 526 um it is
# 0.2 um, a quarter of the 0.9 um accuracy of the paper's moulds (doi:10.1126/science.adk4234).
FINE = 4e-4

# Number of triangles of a solid that the default chord error aims at: 100 MB of STL, which common viewers and
# CAM programs can open. Largest number that a stated one may need: 500 MB, a gigabyte of memory. A cap has
# about pi h / (chord error) triangles, for any radius.
USUAL, MOST = 2e6, 1e7

# Least distance of the rims of two caps, and from the edge, in units of the last place of a coordinate in
# single precision, which STL has: one for each of the two coordinates of both points.
APART = 4.0

# Factor of a proposed length, which then suffices also when it is rounded to three digits.
LARGER = 1.0051

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

# First word of the line on the tolerance, which a study replaces.
TOLERANCE = "Tolerance"

# Decimals of a length in millimetres: a hundredth of a micrometre, a tenth of what machines position.
DECIMALS = 5


@dataclass(frozen=True, eq=False)
class Part:
    """A part whose caps can be made, with the options of its files."""

    surface: Surface  # its asperities, followed by its alignment asperities
    block: Block
    chord_error: float  # [mm]

    @doing("writing the part")
    def write(self, folder: Path) -> None:
        """Write the solids block.stl and mould.stl into a folder as binary STL, in millimetres."""
        import meshio

        block = block_mesh(self.surface, self.block, self.chord_error)
        mould = mould_mesh(block, self.surface, self.block)
        for name, (vertices, faces) in {"block.stl": block, "mould.stl": mould}.items():
            meshio.Mesh(vertices, [("triangle", faces)]).write(folder / name, "stl", binary=True)


def planned(surface: Surface, template: Surface, options: PartSection) -> Part | None:
    """Return the part of a surface, or None if the surface has no block.

    Raises
    ------
    InvalidInput
        If a cap cannot be made, or if the chord error needs too many triangles.
    """
    whole = with_alignment(surface, template, options.alignment_height)
    if surface.block is None:
        return None
    refuse_impossible(whole, surface.block, surface.count)
    sides = math.pi * float(whole.height.sum())  # triangles times chord error
    chord_error = options.chord_error or max(FINE * float(whole.radius.min()), sides / USUAL)
    words = f"needs about {sides / chord_error:.2g} triangles; choose a larger one, for at most {MOST:,.0f}"
    given = f"{chord_error * MICROMETRES:g} um"
    refuse_if(sides / chord_error > MOST, words, key="part.chord_error", value=given)
    return Part(whole, surface.block, chord_error)


def part_notes(part: Part | None) -> tuple[Note, ...]:
    """Return the note that no part or no drilling program was written, if so."""
    if part is None:
        words = "no part was written: the surface has no block; add a block with width, length and thickness"
        return (information(words),)
    words = "mould.gcode was not written: one ball-end mill cannot make all holes of mould.csv"
    return () if drilled(part.surface) else (information(words),)


def with_alignment(surface: Surface, template: Surface, height: float | None) -> Surface:
    """Return the asperities of a part, followed by four alignment asperities of `height` [mm].

    They lie one pitch outside the corners of the template, along x and along y; the pitch is the smallest
    distance between two sites of the template. They have the cap and the radius in use with the smallest
    radius with which a cap can have this height (a sphere needs a radius of at least the height), so that the
    part needs no further tool. If `height` is None, there are none. Raise InvalidInput if the height does not
    exceed the tallest summit, or if no cap can have this height.
    """
    from scipy.spatial import KDTree

    if height is None:
        return surface
    site, tallest, most = template.position, float(surface.height.max()), surface.cap.tallest(surface.radius)
    words = "needs a template of at least two sites, for its pitch; omit it"
    refuse_if(len(site) < 2, words, key="part.alignment_height")
    given: dict[str, Any] = {"key": "part.alignment_height", "value": f"{height:g} mm"}
    words = f"must exceed the tallest summit, {tallest:g} mm, so that the alignment asperities touch first"
    refuse_if(height <= tallest, words, **given)
    words = f"exceeds {most.max():.4g} mm, the largest height of a cap of the radii in use"
    refuse_if(height > most.max(), words, **given)
    pitch = float(KDTree(site).query(site, k=2)[0][:, 1].min())
    (west, south), (east, north) = site.min(axis=0) - pitch, site.max(axis=0) + pitch
    high = np.flatnonzero(most >= height)
    used = int(high[surface.radius[high].argmin()])
    return surface.replaced(
        position=[*surface.position, (west, south), (east, south), (west, north), (east, north)],
        height=np.append(surface.height, [height] * 4),
        radius=np.append(surface.radius, [surface.radius[used]] * 4),
        cap=Caps.of(surface.cap.one(i) for i in (*range(surface.count), *[used] * 4)),
        friction=None,
        cell=None,  # the alignment asperities do not repeat
    )


def refuse_impossible(surface: Surface, block: Block, asperities: int) -> None:
    """Raise InvalidInput if a cap cannot have its height, overlaps another cap or leaves the block.

    The first `asperities` caps are those of the design, and all others are for alignment.
    """
    from scipy.spatial import KDTree

    h, R = surface.height, surface.radius
    most, room = surface.cap.tallest(R), 0.5 * np.array([block.width, block.length])
    apart = APART * float(np.finfo(np.float32).eps * room.max())
    base = surface.cap.foot_radius(np.clip(h, 0.0, most), R)

    def refuse(rows: Any, words: str, key: str) -> None:
        """Raise the error for asperities `rows`; for alignment asperities its key is alignment_height."""
        places = " and ".join(f"({x:g}, {y:g}) mm" for x, y in surface.position[rows].tolist())
        key = key if max(rows) < asperities else "part.alignment_height"
        raise InvalidInput(f"does not suit the part: the asperities at {places} {words}", key=key)

    for i in np.flatnonzero((base <= 2.0 * apart) | (h > most))[:1]:
        words = f"have a cap of radius {R[i]:g} mm and height {h[i]:g} mm; it must be higher than 0 in single"
        refuse([i], f"{words} precision, and at most {most[i]:.4g} mm", "limits.max_height")
    ends = np.abs(surface.position) + base[:, None] + apart
    for i in np.flatnonzero((ends >= room).any(axis=1))[:1]:
        needed = " by ".join(f"{LARGER * 2.0 * end:.3g}" for end in ends.max(axis=0))
        words = f"leave the block of {2 * room[0]:g} by {2 * room[1]:g} mm; it must be at least {needed} mm"
        refuse([i], words, "block.width" if ends[i, 0] >= room[0] else "block.length")
    pairs = KDTree(surface.position).query_pairs(2.0 * float(base.max()) + apart, output_type="ndarray")
    distance = np.linalg.norm(np.diff(surface.position[pairs], axis=1)[:, 0], axis=1)
    for row in np.flatnonzero(distance <= base[pairs].sum(axis=1) + apart)[:1]:
        i = max(pairs[row].tolist(), key=lambda i: base[i])
        top = float(surface.cap.one(i).depth_at(min(0.5 * distance[row], base[i]), float(R[i]))) / LARGER
        remedy = f"at this distance equal caps can be {top:.3g} mm high; increase the pitch or lower them"
        refuse(pairs[row], f"overlap or touch; {remedy}", "limits.max_height")


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


def mould_table(design: Design, part: Surface) -> str:
    """Return the text of mould.csv: one hole for each summit, of kind "asperity" or "alignment".

    `part` holds the asperities of the design, followed by the alignment asperities. Sites are numbered as in
    ``heights.csv``. The depth of a hole below the face of the mould is the height of its summit, and the
    radius of its tool is the radius of the summit.
    """
    more = part.count - design.sites.size
    x, y = mirrored(part.position).T
    lengths = {"x_mm": x, "y_mm": y, "depth_mm": part.height, "tool_radius_mm": part.radius}
    columns = {
        "number": range(1, part.count + 1),
        "kind": ["asperity"] * design.sites.size + ["alignment"] * more,
        "site": [*(design.sites + 1), *[""] * more],
        **{name: map(number_text, values) for name, values in lengths.items()},
        **caps_column(part),
    }
    return "".join(f"# {line}\n" for line in _head(design, part)) + csv(columns)


def _head(design: Design, part: Surface) -> Iterator[str]:
    """Yield what a workshop must know beside the holes."""
    yield "Holes of the mould in mm, seen from its open face, as on the machine; the part is mirrored."
    yield "Origin: centre of the block, in the face of the mould. Depths are measured down from the face."
    if (block := design.surface.block) is not None:
        inside = f"{block.width:g} by {block.length:g} mm inside the frame"
        thick = f"mould.stl is {block.thickness + float(part.height.max()):g} mm thick"
        yield f"Casting: {inside}, {block.thickness:g} mm above the face; {thick}."
    sd = design.limits.height_sd
    stated = f"standard deviation of the depths {MICROMETRES * (sd or 0.0):g} um, from limits.height_sd"
    answer = f"{stated if sd else 'not stated'}; the command metafem study manufacturing replaces this line."
    yield f"{TOLERANCE}: {answer}"


def with_tolerance(text: str, words: str) -> str:
    """Return the text of mould.csv or mould.gcode with other words on the tolerance."""
    plain = words.replace("µ", "u").translate(str.maketrans("()", "[]"))
    line = re.compile(rf"(?m)^(# |\(){TOLERANCE}: .*?(\)?)$")
    return line.sub(lambda found: f"{found[1]}{TOLERANCE}: {plain}{found[2] or ''}", text)


def drilling_program(design: Design, part: Surface, options: PartSection) -> dict[str, str]:
    """Return the text of mould.gcode by its name; none if the holes need more than one ball-end mill.

    The tool plunges into each hole to the depth of its cap, dwells and returns to the safe height. Z is 0 at
    the face of the mould; X and Y are those of mould.csv. There is no tool change.
    """
    if not drilled(part):
        return {}
    tool, deepest = number_text(part.radius[0]), number_text(part.height.max())
    safe = number_text(options.safe_height)
    lines = [
        f"(metafem: {part.count} holes, ball-end mill of radius {tool} mm, deepest hole {deepest} mm, "
        "dwell P in seconds; check this program on the machine before use)",
        *(f"({line})" for line in _head(design, part)),
        *("G21", "G90", "G54", f"S{options.spindle:g} M3", f"G0 Z{safe}"),
    ]
    for (x, y), depth in zip(mirrored(part.position), part.height, strict=True):
        lines += [f"G0 X{number_text(x)} Y{number_text(y)}", f"G1 Z{number_text(-depth)} F{options.feed:g}"]
        lines += [f"G4 P{options.dwell:g}"] if options.dwell > 0.0 else []
        lines.append(f"G0 Z{safe}")
    return {"mould.gcode": "\n".join([*lines, "M5", "M30"]) + "\n"}


def drilled(part: Surface) -> bool:
    """Return whether one ball-end mill makes all holes."""
    return part.cap == SPHERE and float(np.ptp(part.radius)) == 0.0


def number_text(value: float) -> str:
    """Return a length [mm] as text with `DECIMALS` decimals.

    Examples
    --------
    >>> number_text(0.1 + 0.047), number_text(-0.0)
    ('0.14700', '0.00000')
    """
    return f"{round(float(value), DECIMALS) + 0.0:.{DECIMALS}f}"
