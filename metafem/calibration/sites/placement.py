"""Assignment of the contacts in an image to sites whose positions are known from another image."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.sites.search import (
    REFINED,
    IntArray,
    Pose,
    Search,
    complex_points,
    real_points,
)

# Number of regions from which the shift is guessed; at least one of them is assumed to be a contact.
GUESSES = 8

# A shift by more than HALF the distance between neighbouring sites is used only if it matches clearly more
# regions than a shorter shift. The difference must be at least MORE regions and at least the fraction PART of
# all regions. On a full 8 x 8 lattice, a wrong shift by one pitch loses 1/8 of the regions.
HALF, MORE, PART = 0.5, 3, 0.1

# Longest unambiguous shift, over the distance between neighbouring sites. If a shift were longer than 0.4,
# the shift to the next site, 0.6, would be nearly as short.
CERTAIN = 0.4

# Largest distance between a region at the edge of the frame and its site, in semi-axes of the region. The
# distance is 0.8 for half a circle, and larger if less of the circle is visible. Other regions contain their
# sites.
SEMI_AXES = 1.5


@dataclass(frozen=True, eq=False, repr=False)
class Placed(Value):
    """Sites in an image, with their contacts.

    Attributes
    ----------
    position : ndarray, (m, 2)
        Positions of the sites in the image [mm].
    site : ndarray of int, (n,)
        Site of each contact of the image; -1 for a contact that could not be measured or has no site.
    outside : ndarray of bool, (m,)
        Whether each site is outside the frame.
    spoilt : tuple
        Pairs of a site that could not be measured and the reason.
    unclear : bool
        Whether another shift, which differs by a distance between sites, matches about as many regions.
    shift : complex
        Displacement of the sites relative to the other image [mm], x + i y.
    """

    position: FloatArray
    site: IntArray
    outside: NDArray[np.bool_]
    spoilt: tuple[tuple[int, str], ...]
    unclear: bool = False
    shift: complex = 0j

    def values(self, of_contact: FloatArray, of_open: float) -> FloatArray:
        """Return a quantity of the contacts at the sites, (m,); nan where it was not measured."""
        result = np.where(self.outside, np.nan, of_open)
        result[[site for site, _ in self.spoilt]] = np.nan
        matched = self.site >= 0
        result[self.site[matched]] = of_contact[matched]
        return result


def placed(
    areas: ContactAreas,
    position: FloatArray,
    names: list[str],
    reach: FloatArray | None = None,
    before: Placed | None = None,
) -> Placed:
    """Return the sites in an image, from their positions (m, 2) in another image of the sample.

    The sample may move between two images. The shortest shift is assumed, unless a longer shift matches
    clearly more regions. Regions at the edge and merged regions count too. `names` are the names of the sites
    in remarks, and `reach` (m,) the errors of uncertain positions [mm]; default: 0. If `before` is not None,
    its shift is used; `before` is an earlier result for the same image with more sites.
    """
    own = np.zeros(len(position)) if reach is None else reach
    view = _View(areas, Search(complex_points(areas.centre[areas.complete]), complex_points(position)), own)
    if before is None:
        pose, unclear = view.drifted()
    else:
        pose, unclear = view.settled(before.shift), before.unclear
    where = real_points(pose.image(view.search.sites))
    site = np.full(areas.count, -1, dtype=np.intp)
    site[areas.complete] = pose.site
    taken = set(pose.site[pose.site >= 0].tolist())
    for region in np.flatnonzero(areas.complete & (site < 0)).tolist():
        inside = view.within(region, where, taken)
        if len(inside) == 1 and own[inside[0]] > 0.0:
            site[region] = inside[0]
            taken.update(inside)
    outside = np.any((where < 0.0) | (where > areas.frame), axis=1)
    outside[site[site >= 0]] = False
    spoilt: list[tuple[int, str]] = []
    for region in np.flatnonzero(site < 0).tolist():
        inside = view.within(region, where, taken)
        taken.update(inside)
        spoilt += [(s, _reason(areas, region, inside, s, names)) for s in inside]
    return Placed(where, site, outside, tuple(sorted(spoilt)), unclear, pose.shift)


@dataclass(frozen=True)
class _View:
    """Regions of an image, the search for the sites of the complete regions, and errors of the sites."""

    areas: ContactAreas
    search: Search
    own: FloatArray

    def drifted(self) -> tuple[Pose, bool]:
        """Return the shift with the sites of the complete regions, and whether another shift is possible."""
        points, sites, spacing = self.search.points, self.search.sites, self.search.spacing
        if not points.size:
            return Pose(1.0, 0.0), False
        some = points[np.unique(np.linspace(0, len(points) - 1, GUESSES).astype(int))]
        shift = np.append((some[:, None] - sites).ravel(), 0.0)
        shift = shift[np.argsort(np.abs(shift), kind="stable")]
        rated = self.search.rating(np.ones(len(shift), complex), shift)
        short = np.flatnonzero(np.abs(shift) <= HALF * spacing)
        best = [
            *np.argsort(-rated, kind="stable")[:REFINED],
            *short[np.argsort(-rated[short], kind="stable")][:GUESSES],
        ]
        poses = [self.settled(complex(shift[i])) for i in dict.fromkeys(best)]
        found = [(pose, self.votes(pose)) for pose in poses]
        order = sorted(found, key=lambda one: (-one[1], abs(one[0].shift)))
        near, votes = next((one for one in order if abs(one[0].shift) <= HALF * spacing), order[0])
        most = order[0][1]
        clearly = max(MORE, PART * self.areas.count)
        chosen, own = order[0] if most - votes >= clearly else (near, votes)
        if chosen is near and votes == most and abs(near.shift) <= CERTAIN * spacing:
            return near, False
        others = [count for pose, count in found if abs(pose.shift - chosen.shift) > HALF * spacing]
        return chosen, max(others, default=0) > own - clearly

    def votes(self, pose: Pose) -> int:
        """Return the number of regions at sites, including merged regions and regions at the edge."""
        where = real_points(pose.image(self.search.sites))
        taken = set(pose.site[pose.site >= 0].tolist())
        count = len(taken)
        complete = self.areas.complete
        rest = [np.flatnonzero(complete)[pose.site < 0], np.flatnonzero(~complete)]
        for region in np.concatenate(rest).tolist():
            inside = self.within(region, where, taken)
            taken.update(inside)
            count += bool(inside)
        return count

    def settled(self, shift: complex) -> Pose:
        """Return the median shift of the complete regions near sites."""
        search, reach = self.search, self.search.reach()
        for _ in range(3):
            pose = Pose(1.0, shift)
            site, _ = search.assigned(pose, reach)
            matched = site >= 0
            if not matched.any():
                break
            away = search.points[matched] - search.sites[site[matched]]
            shift = complex(np.median(away.real), np.median(away.imag))
            reach = search.reach(np.abs(away - shift))
        return replace(pose, site=site)

    def within(self, region: int, where: FloatArray, taken: set[int]) -> list[int]:
        """Return the free sites within a region's ellipse or near its centre, the nearest site first."""
        areas = self.areas
        away = where - areas.centre[region]
        cos, sin = np.cos(areas.angle[region]), np.sin(areas.angle[region])
        along, across = away @ [cos, sin], away @ [-sin, cos]
        distance = np.hypot(along / areas.axes[region, 0], across / areas.axes[region, 1])
        close = distance <= (SEMI_AXES if areas.edge[region] else 1.0)
        close |= np.hypot(*away.T) < self.own
        order = np.argsort(distance, kind="stable")
        return [site for site in order[close[order]].tolist() if site not in taken]


def _reason(areas: ContactAreas, region: int, inside: list[int], site: int, names: list[str]) -> str:
    """Return the reason why the area at a site is not measured."""
    others = [names[s] for s in inside if s != site]
    if others:
        return f"merged with {' and '.join(others)}"
    if areas.edge[region]:
        return "at the edge of the frame"
    if areas.merged[region]:
        return "its outline is no ellipse, as that of two contacts in one"
    return "its region is not centred on the site, as if merged with another"


def mean_positions(
    found: Sequence[Placed | None], areas: Sequence[ContactAreas], centre: FloatArray
) -> FloatArray:
    """Return the mean positions of contacts over the images [mm], (m, 2), after removal of the shifts."""
    total, count = np.zeros_like(centre), np.zeros(len(centre))
    for one, each in zip(found, areas, strict=True):
        if one is not None:
            matched = one.site >= 0
            sites = one.site[matched]
            shift = one.position[0] - centre[0]
            total[sites] += each.centre[matched] - shift
            count[sites] += 1
    return total / count[:, None]
