"""Alignment asperities, and checks that the caps can be made."""

from __future__ import annotations

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.contact.cap_geometry import SPHERES, CapShape
from metafem.errors import InvalidInput
from metafem.surface import Block, Surface


def alignment_positions(template: Surface) -> FloatArray:
    """Return the positions of four alignment asperities, (4, 2) [mm].

    One lattice pitch outside the corners of the template, along x and along y; the pitch is the
    smallest distance between two of its sites.
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


def with_alignment(
    surface: Surface, template: Surface, height: float | None, shape: CapShape = SPHERES
) -> Surface:
    """Return the asperities of a part and, after them, four alignment asperities of a height [mm], if any.

    Their radius is the smallest in use with which a cap can be so high, for spheres one that is not below
    their height: the part needs no further tool, and no other of its tools makes narrower caps of that
    height. Raise InvalidInput if the height does not exceed the tallest summit, or exceeds that of all caps.
    """
    if height is None:
        return surface
    tallest, most = float(surface.height.max()), shape.tallest(surface.radius)
    top = check.number("part.alignment_height", height)
    if top <= tallest:
        raise InvalidInput(
            f"part.alignment_height = {top:g} mm must exceed the tallest summit, {tallest:g} mm, "
            "so that the alignment asperities touch first"
        )
    if top > most.max():
        limit = (
            f"the largest radius in use, {most.max():g} mm; a cap is at most as high as its radius"
            if shape is SPHERES
            else f"{most.max():.4g} mm, where the profile of the caps ends"
        )
        raise InvalidInput(f"part.alignment_height = {top:g} mm exceeds {limit}")
    radius = float(surface.radius[most >= top].min())
    return surface.replaced(
        position=np.vstack([surface.position, alignment_positions(template)]),
        height=np.append(surface.height, np.full(4, top)),
        radius=np.append(surface.radius, np.full(4, radius)),
    )


def refuse_impossible(surface: Surface, block: Block, asperities: int, shape: CapShape = SPHERES) -> None:
    """Raise InvalidInput for heights that caps cannot have, and for caps that overlap or leave the block.

    Those after the first `asperities` are for alignment.
    """
    from scipy.spatial import KDTree

    def name(i: int) -> str:
        x, y = surface.position[i]
        where = f"at ({x:g}, {y:g}) mm"
        if i < asperities:
            return f"asperity {i} {where}"
        return f"alignment asperity {i - asperities} {where} (part.alignment_height)"

    h, R = surface.height, surface.radius
    most = shape.tallest(R)
    for i in np.flatnonzero((h <= 0.0) | (h > most))[:1]:
        needs = (
            f"a cap of radius {R[i]:g} mm needs a height above 0 and at most its radius"
            if shape is SPHERES
            else f"a cap needs a height above 0 and at most {most[i]:.4g} mm, where its profile ends"
        )
        raise InvalidInput(f"{name(i)} has the height {h[i]:g} mm; {needs}")
    base = shape.foot_radius(h, R)
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
