"""Search for the shift, rotation and scale that map the sites of a design to the contacts of an image."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from metafem._validate import FloatArray

IntArray = NDArray[np.intp]

# Largest distance of a contact from the image of its site during the search, over the distance between
# neighbouring sites. Images of two sites are at least 0.9 apart, so that a contact is near only one.
REACH = 0.2

# The same at the end, in medians of all distances: about 7 standard deviations of normal errors (the median
# is 1.18 of them). The smallest bound allows errors of the centres of a few pixels.
MEDIANS, LEAST_REACH = 6.0, 0.02

# Largest distance of two contacts that are compared with pairs of sites. Longer pairs have smaller errors of
# direction, but open contacts invalidate more of them.
LONGEST = 6.0

# Number of pairs that are compared, of contacts that rate a similarity, and of similarities that are refined.
# If a fifth of the regions are not contacts, a third of the pairs are useless.
PAIRS, RATING, REFINED = 30, 40, 24

# Factors on the stated ranges of rotation and scale in the search, for the errors of short pairs.
SLACK = 1.2


@dataclass(frozen=True)
class Pose:
    """A similarity, and the site of each contact, -1 if none: (n,)."""

    similarity: Similarity
    site: IntArray

    @property
    def matched(self) -> int:
        """Number of contacts that have a site."""
        return int(np.count_nonzero(self.site >= 0))


@dataclass(frozen=True)
class Lattice:
    """The sites of a design as they appear in the image, in any arrangement."""

    sites: ComplexArray

    @cached_property
    def tree(self) -> Any:
        """The sites in a tree of their positions."""
        return cKDTree(real_points(self.sites))

    @cached_property
    def spacing(self) -> float:
        """Median distance of a site from its nearest neighbour [mm]."""
        distance, _ = self.tree.query(real_points(self.sites), k=2)
        return float(np.median(distance[:, 1]))

    def nearest(self, points: ComplexArray, reach: float) -> tuple[FloatArray, IntArray]:
        """Return the nearest site of each point of the design and its distance; inf beyond `reach`."""
        flat = points.ravel()
        distance, site = self.tree.query(real_points(flat), distance_upper_bound=reach)
        return distance.reshape(points.shape), site.reshape(points.shape)

    def pairs(self) -> tuple[IntArray, IntArray]:
        """Return first and second sites of the compared pairs, in both orders."""
        first, second = near_pairs(self.tree, 1.2 * LONGEST * self.spacing)
        return np.concatenate([first, second]), np.concatenate([second, first])


@dataclass(frozen=True)
class Bounds:
    """Rotations within `turn` of `rotation` [rad], and scales within `stretch` of 1."""

    rotation: float
    turn: float
    stretch: float

    def admit(self, factor: Any, slack: float = SLACK) -> Any:
        """Whether the factors of similarities are within the bounds."""
        angle = np.abs(np.angle(factor * np.exp(-1j * self.rotation)))
        return (angle <= slack * self.turn) & (np.abs(np.abs(factor) - 1.0) <= slack * self.stretch)


def reach_of(distance: FloatArray | None, lattice: Lattice) -> float:
    """Return the largest distance of a contact from its site [mm]; `distance` None: not yet known."""
    if distance is None:
        return REACH * lattice.spacing
    return min(
        max(MEDIANS * float(np.median(distance)), LEAST_REACH * lattice.spacing), reach_of(None, lattice)
    )


def near_pairs(tree: Any, reach: float) -> tuple[IntArray, IntArray]:
    """Return the pairs of points within a distance, in a fixed order."""
    pairs = tree.query_pairs(reach, output_type="ndarray")
    pairs = pairs[np.lexsort(pairs.T[::-1])]
    return pairs[:, 0], pairs[:, 1]


def searched(points: ComplexArray, lattice: Lattice, bounds: Bounds) -> list[Pose]:
    """Return the poses that the search finds, sorted by the number of matched contacts."""
    factor, shift = _candidates(points, lattice, bounds)
    if not factor.size:
        return []
    rated = rating(points, lattice, factor, shift)
    best = np.argsort(-rated, kind="stable")[:REFINED]
    return _ordered(
        points, lattice, [Similarity(complex(factor[i]), complex(shift[i])) for i in best], bounds
    )


def shifted(points: ComplexArray, lattice: Lattice, pose: Pose, bounds: Bounds) -> list[Pose]:
    """Return the poses with the rotation and scale of a pose and any shift, the best first.

    Each of them maps some site to the contact nearest to the middle of the matched ones.
    """
    matched = np.flatnonzero(pose.site >= 0)
    middle = matched[np.argmin(np.abs(points[matched] - points[matched].mean()))]
    factor = np.full(len(lattice.sites), pose.similarity.factor)
    shift = points[middle] - factor * lattice.sites
    rated = rating(points, lattice, factor, shift)
    best = np.argsort(-rated, kind="stable")[:REFINED]
    similarities = [pose.similarity, *(Similarity(complex(factor[i]), complex(shift[i])) for i in best)]
    return _ordered(points, lattice, similarities, bounds)


def _candidates(points: ComplexArray, lattice: Lattice, bounds: Bounds) -> tuple[ComplexArray, ComplexArray]:
    """Return factors and shifts of the similarities that map a pair of sites to a pair of contacts."""
    first, second = near_pairs(cKDTree(real_points(points)), LONGEST * lattice.spacing)
    apart = np.abs(points[second] - points[first])
    long = np.flatnonzero(apart > REACH * lattice.spacing)
    chosen = long[np.unique(np.linspace(0, len(long) - 1, PAIRS).astype(int))] if long.size else long
    site, other = lattice.pairs()
    between = lattice.sites[other] - lattice.sites[site]
    factors, shifts = [np.zeros(0, complex)], [np.zeros(0, complex)]
    for i in chosen:
        factor = (points[second[i]] - points[first[i]]) / between
        admitted = np.flatnonzero(bounds.admit(factor))
        factors.append(factor[admitted])
        shifts.append(points[first[i]] - factor[admitted] * lattice.sites[site[admitted]])
    return np.concatenate(factors), np.concatenate(shifts)


def rating(points: ComplexArray, lattice: Lattice, factor: ComplexArray, shift: ComplexArray) -> FloatArray:
    """Return for each similarity the number of contacts near sites, each weighted by its distance."""
    some = points[np.unique(np.linspace(0, len(points) - 1, RATING).astype(int))]
    reach = reach_of(None, lattice)
    distance, _ = lattice.nearest((some - shift[:, None]) / factor[:, None], reach)
    return np.asarray(np.maximum(1.0 - (distance / reach) ** 2, 0.0).sum(axis=1))


def _ordered(
    points: ComplexArray, lattice: Lattice, similarities: list[Similarity], bounds: Bounds
) -> list[Pose]:
    """Return the different poses to which the similarities are refined, sorted by their matches."""
    found: dict[bytes, Pose] = {}
    for similarity in similarities:
        pose = _refined(points, lattice, similarity)
        if pose is not None and bounds.admit(pose.similarity.factor):
            found.setdefault(pose.site.tobytes(), pose)
    return sorted(found.values(), key=lambda pose: -pose.matched)


def _refined(points: ComplexArray, lattice: Lattice, similarity: Similarity) -> Pose | None:
    """Return the pose with the least squares of the distances of its matched contacts."""
    reach, before = reach_of(None, lattice), None
    for _ in range(20):  # converges after three or four
        site, distance = assigned(points, lattice, similarity, reach)
        matched = site >= 0
        if np.count_nonzero(matched) < 2:
            return None
        if before is not None and np.array_equal(site, before):
            break
        similarity, before = fitted(points[matched], lattice.sites[site[matched]]), site
        _, distance = assigned(points, lattice, similarity, reach)
        reach = reach_of(distance[np.isfinite(distance)], lattice)
    return Pose(similarity, site)


def assigned(
    points: ComplexArray, lattice: Lattice, similarity: Similarity, reach: float
) -> tuple[IntArray, FloatArray]:
    """Return the site of each contact, -1 if none, and its distance; of two contacts the nearer is used."""
    distance, nearest = lattice.nearest(similarity.sites(points), reach)
    site = np.full(len(points), -1, dtype=np.intp)
    order = np.argsort(distance, kind="stable")
    order = order[np.isfinite(distance[order])]
    _, first = np.unique(nearest[order], return_index=True)
    chosen = order[first]
    site[chosen] = nearest[chosen]
    return site, distance


ComplexArray = NDArray[np.complex128]


@dataclass(frozen=True)
class Similarity:
    """The map w -> factor w + shift of the plane, with points x + iy as complex numbers."""

    factor: complex
    shift: complex

    def image(self, sites: ComplexArray) -> ComplexArray:
        """Return the images of sites."""
        return self.factor * sites + self.shift

    def sites(self, points: ComplexArray) -> ComplexArray:
        """Return the points of the design from their images."""
        return (points - self.shift) / self.factor


def complex_points(points: FloatArray, mirrored: bool = False) -> ComplexArray:
    """Return points (n, 2) as x + iy, or as -x + iy."""
    x, y = np.asarray(points, dtype=np.float64).T
    return np.asarray((-x if mirrored else x) + 1j * y, dtype=np.complex128)


def real_points(points: ComplexArray) -> FloatArray:
    """Return complex numbers as points (n, 2)."""
    return np.column_stack([points.real, points.imag])


def fitted(points: ComplexArray, sites: ComplexArray) -> Similarity:
    """Return the similarity that minimises the squares of ``points - image(sites)``; two pairs are enough."""
    middle, origin = points.mean(), sites.mean()
    away = sites - origin
    factor = np.vdot(away, points - middle) / np.vdot(away, away).real
    return Similarity(complex(factor), complex(middle - factor * origin))
