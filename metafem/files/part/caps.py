"""Alignment asperities, and checks that caps can be manufactured."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem.caps import SPHERE, Caps
from metafem.errors import InvalidInput, refuse_if
from metafem.surface import Block, Surface

# Number of digits of a length that a message proposes.
DIGITS = 3

# Least distance of the rims of two caps, and from the edge, in units of the last place of a coordinate in
# single precision, which STL has: one for each of the two coordinates of both points.
APART = 4.0

# Advice on alignment asperities that cannot be made.
LEAVE_OUT = "leave out part.alignment_height: the part then has no alignment asperities"


def alignment_positions(template: Surface) -> FloatArray:
    """Return the positions of four alignment asperities, (4, 2) [mm].

    They lie one pitch outside the corners of the template, along x and along y. The pitch is the smallest
    distance between two sites of the template.
    """
    from scipy.spatial import KDTree

    words = "needs a template of at least two sites, for its pitch; omit it"
    refuse_if(template.count < 2, words, key="part.alignment_height")
    distance, _ = KDTree(template.position).query(template.position, k=2)
    pitch = float(distance[:, 1].min())
    (west, south), (east, north) = (
        template.position.min(axis=0) - pitch,
        template.position.max(axis=0) + pitch,
    )
    return np.array([(west, south), (east, south), (west, north), (east, north)])


def with_alignment(surface: Surface, template: Surface, height: float | None) -> Surface:
    """Return the asperities of a part, followed by four alignment asperities of `height` [mm].

    If `height` is None, the part has no alignment asperities. Otherwise these have the cap and the
    radius in use with the smallest radius with which a cap can have this height (a sphere needs a radius of
    at least the height). The part then needs no further tool. Raise InvalidInput
    if the height does not exceed the tallest summit, or if no cap can have this height.
    """
    if height is None:
        return surface
    tallest, most = float(surface.height.max()), surface.cap.tallest(surface.radius)
    given: dict[str, Any] = {"key": "part.alignment_height", "value": f"{height:g} mm"}
    between = 0.5 * (tallest + most.max())
    if tallest < float(f"{between:.4g}") < most.max():
        given["example"] = f'"{between:.4g} mm"'
    must = f"must exceed the tallest summit, {tallest:g} mm, so that the alignment asperities touch first"
    refuse_if(height <= tallest, f"{must}; {LEAVE_OUT}. Or raise it", **given)
    limit = f"the largest radius in use, {most.max():g} mm; a cap is at most as high as its radius"
    if surface.cap != SPHERE:
        limit = f"{most.max():.4g} mm, where the profile of the caps ends"
    refuse_if(height > most.max(), f"exceeds {limit}; {LEAVE_OUT}. Or lower it", **given)
    high = np.flatnonzero(most >= height)
    used = int(high[surface.radius[high].argmin()])
    every = [surface.cap.one(i) for i in (*range(surface.count), *[used] * 4)]
    return surface.replaced(
        position=np.vstack([surface.position, alignment_positions(template)]),
        height=np.append(surface.height, np.full(4, height)),
        radius=np.append(surface.radius, np.full(4, surface.radius[used])),
        cap=Caps.of(every),
        friction=None,
        cell=None,  # the alignment asperities do not repeat
    )


def refuse_impossible(surface: Surface, block: Block, asperities: int) -> None:
    """Raise InvalidInput if a cap cannot have its height, overlaps another cap or leaves the block.

    The first `asperities` caps are those of the design, and all others are for alignment.
    """
    from scipy.spatial import KDTree

    def name(i: int) -> str:
        x, y = surface.position[i]
        where = f"at ({x:g}, {y:g}) mm"
        return f"asperity {i} {where}" if i < asperities else f"alignment asperity {i - asperities} {where}"

    def refused(words: str, remedy: str, key: str, *rows: int) -> InvalidInput:
        """Return the error for asperities `rows`; for alignment asperities its key is alignment_height."""
        if max(rows) < asperities:
            return InvalidInput(f"does not suit the part: {words}; {remedy}", key=key)
        why = f"cannot be made: {words}; {LEAVE_OUT}. Or {remedy}"
        return InvalidInput(why, key="part.alignment_height", value=f"{h[-1]:g} mm")

    h, R = surface.height, surface.radius
    most = surface.cap.tallest(R)
    for i in np.flatnonzero((h <= 0.0) | (h > most))[:1]:
        needs = (
            f"a cap of radius {R[i]:g} mm needs a height above 0 and at most its radius"
            if surface.cap.one(i) == SPHERE
            else f"a cap needs a height above 0 and at most {most[i]:.4g} mm, where its profile ends"
        )
        words = f"does not suit the part: {name(i)} has the height {h[i]:g} mm"
        raise InvalidInput(f"{words}; {needs}", key="limits.max_height")
    base = surface.cap.foot_radius(h, R)
    room = 0.5 * np.array([block.width, block.length])
    apart = APART * float(np.finfo(np.float32).eps * room.max())
    ends = np.abs(surface.position) + base[:, None] + apart
    for i in np.flatnonzero((ends >= room).any(axis=1))[:1]:
        needed = " by ".join(f"{_rounded(2.0 * end, True):g}" for end in ends.max(axis=0))
        raise refused(
            f"{name(i)} has a cap of base radius {base[i]:.4g} mm, which leaves the block of "
            f"{2 * room[0]:g} by {2 * room[1]:g} mm",
            f"make the block at least {needed} mm, or the lattice smaller",
            "block.width" if ends[i, 0] >= room[0] else "block.length",
            i,
        )
    pairs = KDTree(surface.position).query_pairs(2.0 * float(base.max()) + apart, output_type="ndarray")
    distance = np.linalg.norm(np.diff(surface.position[pairs], axis=1)[:, 0], axis=1)
    for row in np.flatnonzero(distance <= base[pairs].sum(axis=1) + apart)[:1]:
        i, j = pairs[row]
        remedy = "increase the pitch or lower the summits"
        if R[i] == R[j] and surface.cap.one(i) == surface.cap.one(j):
            top = _rounded(
                float(surface.cap.one(i).depth_at(np.array(0.5 * distance[row]), float(R[i]))), False
            )
            remedy += f": with this pitch and radius they can be {top:g} mm high above the base plane"
        raise refused(
            f"{name(i)} and {name(j)} overlap or touch: their caps have base radii of {base[i]:g} and "
            f"{base[j]:g} mm",
            remedy,
            "limits.max_height",
            i,
            j,
        )


def _rounded(value: float, up: bool) -> float:
    """Return the next length above or below `value` that has only `DIGITS` digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - DIGITS + 1)
    count = math.floor(value / step) + 1 if up else math.ceil(value / step) - 1
    return float(f"{step * count:.{DIGITS}g}")
