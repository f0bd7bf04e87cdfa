"""Contacts of an image at sites whose places are known from another image of a stack."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.sites.search import (
    REFINED,
    IntArray,
    Lattice,
    Pose,
    assigned,
    rating,
    reach_of,
)
from metafem.calibration.sites.similarity import ComplexArray, Similarity, complex_points, real_points

# Number of contacts from which a drift is guessed: one of them is a contact.
GUESSES = 8

# A region at the edge of the frame belongs to a site within so many of its semi-axes: half a circle has the
# centre of the circle at 0.8 of its own, a smaller part farther out. Other regions contain their sites.
SEMI_AXES = 1.5


@dataclass(frozen=True, eq=False, repr=False)
class Placed(Value):
    """The sites in an image.

    Attributes
    ----------
    position : ndarray, (m, 2)
        Where the sites are seen [mm].
    site : ndarray of int, (n,)
        Site of each contact of the image that could be measured; -1 for others and for those of no site.
    outside : ndarray of bool, (m,)
        Whether a site is outside the frame.
    spoilt : tuple
        Sites that cannot be measured: pairs of site and reason.
    strays : ndarray of int
        Regions that belong to no site.
    """

    position: FloatArray
    site: IntArray
    outside: NDArray[np.bool_]
    spoilt: tuple[tuple[int, str], ...]
    strays: IntArray

    def values(self, of_contact: FloatArray, of_open: float) -> FloatArray:
        """Return a quantity of the contacts at the sites (m,), nan where it was not measured."""
        result = np.where(self.outside, np.nan, of_open)
        result[[site for site, _ in self.spoilt]] = np.nan
        matched = self.site >= 0
        result[self.site[matched]] = of_contact[matched]
        return result


def placed(areas: ContactAreas, position: FloatArray, names: list[str]) -> Placed:
    """Return the sites in an image, from their positions in another one of the same sample (m, 2).

    Between two images the sample may move, by any distance that leaves one shift as the best; of several
    shifts that match equally many contacts the shortest is meant. `names` are those of the sites in remarks.
    """
    whole = np.flatnonzero(areas.complete)
    points, lattice = complex_points(areas.centre[whole]), Lattice(complex_points(position))
    pose = _drifted(points, lattice)
    where = real_points(pose.similarity.image(lattice.sites))
    site = np.full(areas.count, -1, dtype=np.intp)
    site[whole] = pose.site
    frame = areas.pixel_size * np.array(areas.shape[::-1])
    outside = np.any((where < 0.0) | (where > frame), axis=1)
    outside[site[site >= 0]] = False
    spoilt, strays = [], []
    taken = set(site[site >= 0].tolist())
    for region in np.flatnonzero(site < 0).tolist():
        inside = [s for s in _within(areas, region, where) if s not in taken]
        taken.update(inside)
        spoilt += [(s, _reason(areas, region, inside, s, names)) for s in inside]
        if not inside and not areas.edge[region]:
            strays.append(region)
    return Placed(where, site, outside, tuple(sorted(spoilt)), np.array(sorted(strays), dtype=np.intp))


def _drifted(points: ComplexArray, lattice: Lattice) -> Pose:
    """Return the shift that matches most contacts, and the sites of these."""
    still = Similarity(1.0, 0.0)
    if not points.size:
        return Pose(still, np.zeros(0, dtype=np.intp))
    some = points[np.unique(np.linspace(0, len(points) - 1, GUESSES).astype(int))]
    shift = np.append((some[:, None] - lattice.sites).ravel(), 0.0)
    shift = shift[np.argsort(np.abs(shift), kind="stable")]
    rated = rating(points, lattice, np.ones(len(shift), complex), shift)
    best = np.argsort(-rated, kind="stable")[:REFINED]
    poses = [_settled(points, lattice, complex(shift[i])) for i in best]
    return min(poses, key=lambda pose: (-pose.matched, abs(pose.similarity.shift)))


def _settled(points: ComplexArray, lattice: Lattice, shift: complex) -> Pose:
    """Return the median shift of the contacts near sites."""
    reach = reach_of(None, lattice)
    for _ in range(3):
        similarity = Similarity(1.0, shift)
        site, _ = assigned(points, lattice, similarity, reach)
        matched = site >= 0
        if not matched.any():
            break
        away = points[matched] - lattice.sites[site[matched]]
        shift = complex(np.median(away.real), np.median(away.imag))
        reach = reach_of(np.abs(away - shift), lattice)
    return Pose(similarity, site)


def _within(areas: ContactAreas, region: int, where: FloatArray) -> list[int]:
    """Return the sites within the ellipse of a region, the nearest first."""
    away = where - areas.centre[region]
    cos, sin = np.cos(areas.angle[region]), np.sin(areas.angle[region])
    along, across = away @ [cos, sin], away @ [-sin, cos]
    distance = np.hypot(along / areas.axes[region, 0], across / areas.axes[region, 1])
    order = np.argsort(distance, kind="stable")
    most = SEMI_AXES if areas.edge[region] else 1.0
    return [int(s) for s in order if distance[s] <= most]


def _reason(areas: ContactAreas, region: int, inside: list[int], site: int, names: list[str]) -> str:
    """Return why the area at a site is not measured."""
    others = [names[s] for s in inside if s != site]
    if others:
        return f"merged with {' and '.join(others)}"
    if areas.edge[region]:
        return "at the edge of the frame"
    if areas.merged[region]:
        return "its outline is no ellipse, as that of two contacts in one"
    return "its region is not centred on the site, as if merged with another"
