"""Matching of the summits on a map to the sites of a design, for any orientation of the part."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem._values import percent
from metafem.calibration.sites import FEWEST, match_sites
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note, information
from metafem.surface import Surface

# Largest angle between the axes of the map and the axes of the part, in addition to quarter turns.
TURN = math.radians(20.0)

# The heights decide between two orientations if the ratio of their height misfits exceeds this value.
DECIDED = 1.5


@dataclass(frozen=True, eq=False)
class Alignment:
    """Sites of summits (m,), -1 for no site, and their positions in the design's coordinates (m, 2) [mm].

    `rotation` is the angle of the part on the map, anticlockwise [rad]. `scale` is the ratio of distances on
    the map to distances in the design. `misfit` is the standard deviation of the height errors [mm]. If
    `decided` is false, another orientation or shift of the part fits the heights nearly as well.
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


def aligned(centre: FloatArray, height: FloatArray, design: Surface, mirrored: bool) -> Alignment:
    """Return the alignment of summits (m, 2) with heights (m,) to the sites of a design.

    All quarter turns are compared. `mirrored` states whether the map is mirrored. The turn with the largest
    number of matched summits is used. If several turns match this number, the heights decide.
    """
    if min(len(centre), design.count) < FEWEST:
        return _few(centre, height, design)
    found, refused = [], []
    for quarter in range(4):
        try:
            found.append(_placed(centre, height, design, mirrored, 0.5 * math.pi * quarter))
        except InvalidInput as error:
            refused.append(error)
    if not found:
        raise InvalidInput(str(refused[0]).replace("contacts", "caps").replace("in the image", "on the map"))
    most = max(each.matched for each in found)
    found = [each for each in found if each.matched == most]
    best = min(found, key=lambda each: each.misfit)
    near = [each for each in found if each.misfit <= DECIDED * best.misfit]
    others = any((each.site != best.site).any() for each in near)
    return replace(near[0], decided=False) if others else best  # the first orientation tried


def _placed(
    centre: FloatArray, height: FloatArray, design: Surface, mirrored: bool, rotation: float
) -> Alignment:
    """Return the alignment for one orientation of the map, with summits moved by a rigid motion."""
    side = "block" if mirrored else "glass"
    match = match_sites(centre, design.position, viewed_from=side, rotation=rotation, rotation_range=TURN)
    on_site = match.site >= 0
    points = centre * np.array([-1.0, 1.0]) if mirrored else centre
    position, angle = _rigid(points, points[on_site], design.position[match.site[on_site]])
    misfit = float((height[on_site] - design.height[match.site[on_site]]).std())
    turned = angle if mirrored else -angle
    return Alignment(match.site, position, turned, mirrored, match.scale, misfit, not match.ambiguous)


def _rigid(points: FloatArray, have: FloatArray, wanted: FloatArray) -> tuple[FloatArray, float]:
    """Return points moved by the least-squares rigid motion from `have` to `wanted`, and its angle [rad]."""
    one, other = have - have.mean(axis=0), wanted - wanted.mean(axis=0)
    cross = one.T @ other
    angle = math.atan2(cross[0, 1] - cross[1, 0], cross[0, 0] + cross[1, 1])
    c, s = math.cos(angle), math.sin(angle)
    return (points - have.mean(axis=0)) @ np.array([[c, s], [-s, c]]) + wanted.mean(axis=0), angle


def _few(centre: FloatArray, height: FloatArray, design: Surface) -> Alignment:
    """Return the alignment of one or two summits to as many sites, by the order of their coordinates."""
    refuse_if(
        len(centre) != design.count,
        f"the map shows {len(centre)} caps and the design has {design.count} asperities; at least {FEWEST} "
        "of each are needed to match them",
    )
    site = np.empty(design.count, dtype=np.intp)
    along = centre[-1] - centre[0]
    axis = int(np.abs(along).argmax())
    site[np.argsort(centre[:, axis])] = np.argsort(design.position[:, axis])
    position = centre - centre.mean(axis=0) + design.position.mean(axis=0)
    misfit = float((height - design.height[site]).std())
    return Alignment(site, position, 0.0, False, 1.0, misfit)


# Largest relative error of distances on the map without a note, typical of the calibration of microscopes.
SCALE = 2e-3

# A note is added if the standard deviation of the height errors exceeds the fraction FOREIGN of the standard
# deviation and the fraction FOREIGN_MEAN of the mean of the designed heights. Manufacturing errors are a few
# percent. If the map shows another part, the errors are as large as the differences between heights.
FOREIGN, FOREIGN_MEAN = 0.5, 0.05

# Largest number of caps, hills or missing asperities whose places a note lists.
NAMED = 5

UNDECIDED = "the heights do not show how the part was turned or shifted; the map is used as it is"


def placement_notes(
    design: Surface, centre: FloatArray, place: Alignment, missing: IntArray, other: list[tuple[float, float]]
) -> Iterator[Note]:
    """Return notes on unmatched summits, missing asperities, and rotation, mirroring or scale of the map."""
    for what, places in (
        ("caps of the map have no site in the design", centre[place.site < 0].tolist()),
        ("hills of the map are no caps of the design", other),
        ("asperities of the design are missing on the map", design.position[missing].tolist()),
    ):
        if places:
            first = ", ".join(on_map(*at) for at in places[:NAMED])
            yield Note(f"{len(places)} {what}: {first}" + " and others" * (len(places) > NAMED))
    height = design.height[place.site[place.site >= 0]]
    if place.misfit > FOREIGN * height.std() and place.misfit > FOREIGN_MEAN * height.mean():
        yield Note(
            "the heights of the caps are not those of the design: their errors have the standard deviation "
            f"{place.misfit:g} mm, the designed heights {height.std():g} mm; check the design, and whether "
            "the map shows the mould"
        )
    turn = round(math.degrees(place.rotation) / 90.0) % 4 * 90
    if not place.decided:
        yield information(UNDECIDED)
    elif turn:
        yield information(f"by its heights, the part is turned by {turn} degrees on the map")
    if abs(place.scale - 1.0) > SCALE:
        larger = percent(place.scale - 1.0, "+.2g")
        yield Note(f"distances on the map differ from the design's by {larger}; check pixel_size")


def on_map(x: float, y: float) -> str:
    """Return the coordinates of a point on a map as text."""
    return f"({x:.3f}, {y:.3f}) mm"
