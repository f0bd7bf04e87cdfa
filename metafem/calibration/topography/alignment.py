"""Which site of a design each summit of a map is, whichever way the part lay under the microscope."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.surface import Surface

# A summit belongs to a site if it is nearer than this part of the smallest distance of two sites.
NEAR = 0.35

# Summits around the middle one with which placements are compared at first.
INNER = 40

# Placements that are refined, of each of the eight ways to turn or mirror a part.
REFINED = 4

# Refinements of a placement; two suffice where all summits are near their sites.
STEPS = 5

# Placements whose summits are within this factor of the smallest root mean square distance are all possible.
# The heights decide between them if the misfit of the next best exceeds that of the best by this factor.
SIMILAR, DECIDED = 2.0, 1.5


@dataclass(frozen=True, eq=False)
class Alignment:
    """Sites of summits (m,), -1 where there is none; positions in the design's frame (m, 2) [mm].

    `quarter` is the number of quarter turns that were undone, `rotation` the remaining angle [rad]. If not
    `decided`, another way to turn or mirror the part fits the heights nearly as well.
    """

    site: NDArray[np.intp]
    position: FloatArray
    quarter: int
    mirrored: bool
    rotation: float
    decided: bool
    distance: float  # root mean square distance of the summits from their sites [mm]
    misfit: float  # standard deviation of the height errors [mm]


def aligned(centre: FloatArray, height: FloatArray, design: Surface, mirrored: bool | None) -> Alignment:
    """Match summits (m, 2) with heights (m,) to the sites of a design.

    All quarter turns and shifts are compared, with the map as it is or mirrored (None: both), and the one
    remains in which most summits have a site. Where several remain, the heights decide.
    """
    from scipy.spatial import cKDTree

    tree = cKDTree(design.position)
    if design.count > 1:
        near = NEAR * float(tree.query(design.position, k=2)[0][:, 1].min())
    else:
        near = NEAR * float(design.radius[0])
    middle = centre[((centre - np.median(centre, axis=0)) ** 2).sum(axis=1).argmin()]
    inner = np.argsort(((centre - middle) ** 2).sum(axis=1), kind="stable")[:INNER]
    found = []
    for flip in (False, True) if mirrored is None else (mirrored,):
        for quarter in range(4):
            turned = _turned(centre - middle, quarter, flip)
            shifted = design.position[:, None] + turned[inner]  # the middle summit on each site
            apart = tree.query(shifted.reshape(-1, 2), distance_upper_bound=near)[0].reshape(
                shifted.shape[:2]
            )
            count = np.isfinite(apart).sum(axis=1)
            total = np.where(np.isfinite(apart), apart, near).sum(axis=1)
            for start in np.lexsort((total, -count))[:REFINED]:
                found.append(_refined(turned, height, design, tree, near, int(start), quarter, flip))
    most = max((each.site >= 0).sum() for each in found)
    found = [each for each in found if (each.site >= 0).sum() == most]
    least = min(each.distance for each in found)
    found = [each for each in found if each.distance <= SIMILAR * least + 1e-6 * near]
    # equal misfits: as the map lies
    found.sort(key=lambda each: (round(each.misfit / near, 9), each.mirrored, each.quarter))
    best = found[0]
    others = [each for each in found if (each.site != best.site).any()]
    if others and others[0].misfit <= DECIDED * best.misfit:
        close = [each for each in found if each.misfit <= DECIDED * best.misfit]
        best = min(close, key=lambda each: (each.mirrored, each.quarter, each.misfit))
        return Alignment(**{**vars(best), "decided": False})
    return best


def _turned(points: FloatArray, quarter: int, flip: bool) -> FloatArray:
    """Return points mirrored along x if wanted, then turned by quarters."""
    result = points * np.array([-1.0, 1.0]) if flip else points
    c, s = [(1, 0), (0, 1), (-1, 0), (0, -1)][quarter]
    return np.asarray(result @ np.array([[c, s], [-s, c]], dtype=float))


def _refined(
    turned: FloatArray, height: FloatArray, design: Surface, tree: object, near: float, start: int,
    quarter: int, flip: bool,
) -> Alignment:  # fmt: skip
    """Improve a placement by the rigid motion of least squares between summits and their sites."""
    position, rotation = turned + design.position[start], np.eye(2)
    site = _sites(position, tree, near, len(height))
    for _ in range(STEPS):
        kept = site >= 0
        if not kept.any():
            break
        have, wanted = turned[kept], design.position[site[kept]]
        cross = (have - have.mean(axis=0)).T @ (wanted - wanted.mean(axis=0))
        angle = np.arctan2(cross[0, 1] - cross[1, 0], cross[0, 0] + cross[1, 1])
        rotation = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        position = (turned - have.mean(axis=0)) @ rotation + wanted.mean(axis=0)
        before, site = site, _sites(position, tree, near, len(height))
        if (before == site).all():
            break
    kept = site >= 0
    apart = position[kept] - design.position[site[kept]]
    error = height[kept] - design.height[site[kept]]
    return Alignment(
        site, position, quarter, flip, float(np.arctan2(rotation[0, 1], rotation[0, 0])), True,
        float(np.sqrt((apart**2).sum(axis=1).mean())) if kept.any() else near,
        float(error.std()) if kept.any() else np.inf,
    )  # fmt: skip


def _sites(position: FloatArray, tree: object, near: float, count: int) -> NDArray[np.intp]:
    """Return the nearest site of each summit, and for each site only its nearest summit."""
    apart, site = tree.query(position, distance_upper_bound=near)  # type: ignore[attr-defined]
    order = np.argsort(apart, kind="stable")
    first = np.unique(site[order], return_index=True)[1]
    result = np.full(count, -1, dtype=np.intp)
    result[order[first]] = site[order[first]]
    result[~np.isfinite(apart)] = -1
    return result
