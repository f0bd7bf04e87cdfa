"""Which site of a design each summit of a map is, whichever way the part lay under the microscope."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from metafem._given import label
from metafem._validate import FloatArray
from metafem.calibration.sites.match import FEWEST, match_sites
from metafem.errors import InvalidInput
from metafem.surface import Surface

# Largest angle between the axes of the map and those of the part, after quarter turns.
TURN = math.radians(20.0)

# The heights decide between two ways to turn or mirror a part if the misfit of one exceeds that of the other
# by this factor.
DECIDED = 1.5


@dataclass(frozen=True, eq=False)
class Alignment:
    """Sites of summits (m,), -1 where there is none; positions in the design's frame (m, 2) [mm].

    `rotation` is the angle of the part on the map, anticlockwise [rad], and `scale` that of distances on the
    map. If not `decided`, another way to place the part fits the heights nearly as well. `misfit` is the
    standard deviation of the height errors [mm].
    """

    site: NDArray[np.intp]
    position: FloatArray
    rotation: float
    mirrored: bool
    scale: float
    misfit: float
    decided: bool = True

    @property
    def matched(self) -> int:
        """Number of summits with a site."""
        return int((self.site >= 0).sum())


def aligned(centre: FloatArray, height: FloatArray, design: Surface, mirrored: bool | None) -> Alignment:
    """Match summits (m, 2) with heights (m,) to the sites of a design.

    All quarter turns are compared, with the map as it is or mirrored (None: both), and the one remains in
    which most summits have a site. Where several remain, the heights decide.
    """
    if min(len(centre), design.count) < FEWEST:
        return _few(centre, height, design)
    found, refused = [], []
    for flip in (False, True) if mirrored is None else (mirrored,):
        for quarter in range(4):
            try:
                found.append(_placed(centre, height, design, flip, 0.5 * math.pi * quarter))
            except InvalidInput as error:
                refused.append(error)
    if not found:
        raise InvalidInput(str(refused[0]).replace("contacts", "caps").replace("in the image", "on the map"))
    most = max(each.matched for each in found)
    found = [each for each in found if each.matched == most]
    best = min(found, key=lambda each: each.misfit)
    near = [each for each in found if each.misfit <= DECIDED * best.misfit]
    others = any((each.site != best.site).any() for each in near)
    return replace(near[0], decided=False) if others else best  # the first: as the map lies


def _placed(
    centre: FloatArray, height: FloatArray, design: Surface, mirrored: bool, rotation: float
) -> Alignment:
    """Match summits in one view, then place them by the rigid motion of least squares."""
    side = "block" if mirrored else "glass"
    view = partial(match_sites, viewed_from=side, rotation=rotation, rotation_range=TURN)
    match = view(centre, design.position)
    if match.ambiguous:
        match = view(centre, design.position, area=height, expected_area=design.height)
    kept = match.site >= 0
    points = centre * np.array([-1.0, 1.0]) if mirrored else centre
    position, angle = _rigid(points, points[kept], design.position[match.site[kept]])
    misfit = float((height[kept] - design.height[match.site[kept]]).std())
    turned = angle if mirrored else -angle
    return Alignment(match.site, position, turned, mirrored, match.scale, misfit, not match.ambiguous)


def _rigid(points: FloatArray, have: FloatArray, wanted: FloatArray) -> tuple[FloatArray, float]:
    """Return points under the rigid motion that brings some of them nearest to others, and its angle."""
    one, other = have - have.mean(axis=0), wanted - wanted.mean(axis=0)
    cross = one.T @ other
    angle = math.atan2(cross[0, 1] - cross[1, 0], cross[0, 0] + cross[1, 1])
    c, s = math.cos(angle), math.sin(angle)
    return (points - have.mean(axis=0)) @ np.array([[c, s], [-s, c]]) + wanted.mean(axis=0), angle


def _few(centre: FloatArray, height: FloatArray, design: Surface) -> Alignment:
    """Match one or two summits to as many sites, as the map lies; the order of x and y decides."""
    if len(centre) != design.count:
        raise InvalidInput(
            f"{label('height_map')} shows {len(centre)} caps and {label('design_surface')} has "
            f"{design.count} asperities; at least {FEWEST} of each are needed to match them"
        )
    site = np.empty(design.count, dtype=np.intp)
    along = centre[-1] - centre[0]
    axis = int(np.abs(along).argmax())
    site[np.argsort(centre[:, axis])] = np.argsort(design.position[:, axis])
    position = centre - centre.mean(axis=0) + design.position.mean(axis=0)
    misfit = float((height - design.height[site]).std())
    return Alignment(site, position, 0.0, False, 1.0, misfit)
