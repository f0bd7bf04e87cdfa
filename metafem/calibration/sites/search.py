"""Search for the shift, rotation and scale that map the sites of a design to the contacts of an image."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from metafem._validate import FloatArray

IntArray = NDArray[np.intp]
ComplexArray = NDArray[np.complex128]

# Largest distance between a contact and the image of its site during the search, over the distance between
# neighbouring sites. The images of two sites are at least 0.9 apart, so a contact is near one site only.
REACH = 0.2

# Largest distance between a contact and the image of its site at the end of the search, in medians of all
# distances. This is about 7 standard deviations of normal errors, since the median is 1.18 standard
# deviations. LEAST_REACH, over the distance between sites, allows for errors of a few pixels.
MEDIANS, LEAST_REACH = 6.0, 0.02

# Largest length of a pair of contacts, over the distance between neighbouring sites. Long pairs have small
# errors of direction, but open contacts make many long pairs useless.
LONGEST = 6.0

# Number of compared pairs of contacts, number of contacts that rate a similarity, and number of refined
# similarities. If a fifth of the regions are not contacts, a third of the pairs are useless.
PAIRS, RATING, REFINED = 30, 40, 24

# Factor that widens the ranges of rotation and scale during the search, because short pairs have large
# errors.
SLACK = 1.2


@dataclass(frozen=True)
class Pose:
    """Similarity w -> factor w + shift of the plane, with points as complex numbers x + iy.

    `site` (n,) holds the site of each contact, -1 if it has no site.
    """

    factor: complex
    shift: complex
    site: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.intp))

    @property
    def matched(self) -> int:
        """Number of contacts that have a site."""
        return int(np.count_nonzero(self.site >= 0))

    def image(self, sites: ComplexArray) -> ComplexArray:
        """Return the positions of sites in the image."""
        return self.factor * sites + self.shift

    def sites(self, points: ComplexArray) -> ComplexArray:
        """Return the positions in the design of points in the image."""
        return (points - self.shift) / self.factor


@dataclass(frozen=True)
class Bounds:
    """Bounds of a search: rotations within `turn` of `rotation` [rad], and scales within `stretch` of 1."""

    rotation: float
    turn: float
    stretch: float

    def admit(self, factor: Any) -> Any:
        """Return whether the complex factors of similarities are within the bounds."""
        angle = np.abs(np.angle(factor * np.exp(-1j * self.rotation)))
        return (angle <= SLACK * self.turn) & (np.abs(np.abs(factor) - 1.0) <= SLACK * self.stretch)


@dataclass(frozen=True)
class Search:
    """Search for the similarity that maps the sites of a design, in any arrangement, to contacts."""

    points: ComplexArray
    sites: ComplexArray

    @cached_property
    def tree(self) -> Any:
        """Search tree of the positions of the sites."""
        return cKDTree(real_points(self.sites))

    @cached_property
    def spacing(self) -> float:
        """Median distance between nearest neighbours among the sites [mm]."""
        return spacing_of(self.tree)

    def reach(self, distance: FloatArray | None = None) -> float:
        """Return the largest distance of a contact from its site [mm], based on the distances if known."""
        widest = REACH * self.spacing
        if distance is None:
            return widest
        return min(max(MEDIANS * float(np.median(distance)), LEAST_REACH * self.spacing), widest)

    def nearest(self, points: ComplexArray, reach: float) -> tuple[FloatArray, IntArray]:
        """Return the distance of each point from its nearest site, inf beyond `reach`, and this site."""
        flat = points.ravel()
        distance, site = self.tree.query(real_points(flat), distance_upper_bound=reach)
        return distance.reshape(points.shape), site.reshape(points.shape)

    def rating(self, factor: ComplexArray, shift: ComplexArray) -> FloatArray:
        """Return the rating of each similarity: the number of contacts near sites, weighted by distance."""
        some = self.points[np.unique(np.linspace(0, len(self.points) - 1, RATING).astype(int))]
        reach = self.reach()
        distance, _ = self.nearest((some - shift[:, None]) / factor[:, None], reach)
        return np.asarray(np.maximum(1.0 - (distance / reach) ** 2, 0.0).sum(axis=1))

    def assigned(self, pose: Pose, reach: float) -> tuple[IntArray, FloatArray]:
        """Return the site of each contact, -1 for none, and its distance; a site has one contact at most."""
        distance, nearest = self.nearest(pose.sites(self.points), reach)
        site = np.full(len(self.points), -1, dtype=np.intp)
        order = np.argsort(distance, kind="stable")
        order = order[np.isfinite(distance[order])]
        chosen = order[np.unique(nearest[order], return_index=True)[1]]
        site[chosen] = nearest[chosen]
        return site, distance

    def searched(self, bounds: Bounds) -> list[Pose]:
        """Return the poses found by the search, sorted by the number of matched contacts."""
        factor, shift = self._candidates(bounds)
        return self._ordered(self._best(factor, shift), bounds) if factor.size else []

    def shifted(self, pose: Pose, bounds: Bounds) -> list[Pose]:
        """Return poses with any shift and the rotation and scale of a pose, sorted by matched contacts.

        Each pose maps one of the sites to the matched contact that is nearest to the centre of the matched
        contacts.
        """
        matched = self.points[pose.site >= 0]
        middle = matched[np.argmin(np.abs(matched - matched.mean()))]
        factor = np.full(len(self.sites), pose.factor)
        return self._ordered([pose, *self._best(factor, middle - factor * self.sites)], bounds)

    def _candidates(self, bounds: Bounds) -> tuple[ComplexArray, ComplexArray]:
        """Return the factors and shifts of similarities that map a pair of sites to a pair of contacts."""
        points = self.points
        first, second = _near_pairs(cKDTree(real_points(points)), LONGEST * self.spacing)
        long = np.flatnonzero(np.abs(points[second] - points[first]) > REACH * self.spacing)
        chosen = long[np.unique(np.linspace(0, len(long) - 1, PAIRS).astype(int))] if long.size else long
        one, two = _near_pairs(self.tree, 1.2 * LONGEST * self.spacing)
        site, other = np.concatenate([one, two]), np.concatenate([two, one])
        between = self.sites[other] - self.sites[site]
        factors, shifts = [np.zeros(0, complex)], [np.zeros(0, complex)]
        for i in chosen:
            factor = (points[second[i]] - points[first[i]]) / between
            admitted = np.flatnonzero(bounds.admit(factor))
            factors.append(factor[admitted])
            shifts.append(points[first[i]] - factor[admitted] * self.sites[site[admitted]])
        return np.concatenate(factors), np.concatenate(shifts)

    def _best(self, factor: ComplexArray, shift: ComplexArray) -> list[Pose]:
        """Return the similarities with the highest ratings."""
        best = np.argsort(-self.rating(factor, shift), kind="stable")[:REFINED]
        return [Pose(complex(factor[i]), complex(shift[i])) for i in best]

    def _ordered(self, poses: list[Pose], bounds: Bounds) -> list[Pose]:
        """Return the refined poses without duplicates, sorted by the number of matched contacts."""
        found: dict[bytes, Pose] = {}
        for pose in filter(None, map(self._refined, poses)):
            if bounds.admit(pose.factor):
                found.setdefault(pose.site.tobytes(), pose)
        return sorted(found.values(), key=lambda pose: -pose.matched)

    def _refined(self, pose: Pose) -> Pose | None:
        """Return the least-squares pose of the matched contacts, or None if fewer than two match."""
        reach, before = self.reach(), None
        for _ in range(20):  # three or four steps usually suffice
            site, distance = self.assigned(pose, reach)
            matched = site >= 0
            if np.count_nonzero(matched) < 2:
                return None
            if before is not None and np.array_equal(site, before):
                break
            pose, before = fitted(self.points[matched], self.sites[site[matched]]), site
            _, distance = self.assigned(pose, reach)
            reach = self.reach(distance[np.isfinite(distance)])
        return Pose(pose.factor, pose.shift, site)


def spacing_of(tree: Any) -> float:
    """Return the median distance between nearest neighbours in a tree."""
    distance, _ = tree.query(tree.data, k=2)
    return float(np.median(distance[:, 1]))


def _near_pairs(tree: Any, reach: float) -> tuple[IntArray, IntArray]:
    """Return the pairs of points closer than `reach`, in a reproducible order."""
    pairs = tree.query_pairs(reach, output_type="ndarray")
    pairs = pairs[np.lexsort(pairs.T[::-1])]
    return pairs[:, 0], pairs[:, 1]


def complex_points(points: FloatArray, mirrored: bool = False) -> ComplexArray:
    """Return points (n, 2) as complex numbers x + iy, or -x + iy if mirrored, (n,)."""
    x, y = np.asarray(points, dtype=np.float64).T
    return np.asarray((-x if mirrored else x) + 1j * y, dtype=np.complex128)


def real_points(points: ComplexArray) -> FloatArray:
    """Return complex numbers (n,) as points (n, 2)."""
    return np.column_stack([points.real, points.imag])


def fitted(points: ComplexArray, sites: ComplexArray) -> Pose:
    """Return the similarity with the least squares of ``points - image(sites)``, for at least two pairs."""
    middle, origin = points.mean(), sites.mean()
    away = sites - origin
    factor = np.vdot(away, points - middle) / np.vdot(away, away).real
    return Pose(complex(factor), complex(middle - factor * origin))
