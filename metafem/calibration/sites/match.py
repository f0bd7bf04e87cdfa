"""Matching of the contacts in one image to the sites of a design."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.sites.search import (
    Bounds,
    IntArray,
    Pose,
    Search,
    complex_points,
    real_points,
    spacing_of,
)
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note, information

# The sides from which contacts are viewed, and whether x is then mirrored.
SIDES = {"glass": False, "block": True}

# Smallest number of contacts: shift, rotation and scale have four unknowns, and three contacts six
# coordinates.
FEWEST = 3

# Smallest fraction of the contacts that lie on sites. For a lattice with two thirds or half of the pitch, the
# fraction is at most 0.45.
ON_SITES = 0.6

# Largest rotation and change of scale in the search.
TURN, STRETCH = math.radians(5.0), 0.1


def match_sites(
    centre: ArrayLike,
    site_position: ArrayLike,
    *,
    viewed_from: str = "glass",
    rotation: float = 0.0,
    rotation_range: float = TURN,
    scale_range: float = STRETCH,
    area: ArrayLike | None = None,
    expected_area: ArrayLike | None = None,
    frame: ArrayLike | None = None,
) -> SiteMatch:
    """Match the contacts in an image to the sites of a design, with unknown shift, rotation and scale.

    Pairs of contacts are compared with pairs of sites. Each similarity that maps one to the other is rated by
    the number of contacts near sites, and the best ones are refined by least squares. Open contacts, regions
    that are not contacts and sites outside the frame are allowed.

    Parameters
    ----------
    centre : array_like, (n, 2)
        Centres of the contacts in the image [mm], x to the right and y upwards; at least 3.
    site_position : array_like, (m, 2)
        Sites of the design [mm] as in `heights.csv`, viewed from above the asperities; any arrangement of at
        least 3.
    viewed_from : {"glass", "block"}
        "glass": the view is through the glass onto the summits, as in heights.csv. "block": the view is
        through the base of the block, and the image is mirrored relative to heights.csv, x -> -x, like
        mould.csv. A mirror in the optics or in the camera's software exchanges the two. Default: "glass".
    rotation : float
        Rotation of the design in the image, anticlockwise [rad], if it is known roughly; default: 0.
    rotation_range : float
        Largest difference from it [rad]; default: 5°. On a square lattice it must be less than 45°.
    scale_range : float
        Largest relative error of the pixel size [-]; default: 0.1.
    area, expected_area : array_like, (n,) and (m,)
        Measured areas of the contacts and those that the design's law predicts at their sites [mm^2], up to a
        common factor. They decide if several shifts match equally many contacts, and show if another viewing
        side or a quarter turn is much more likely; default: None.
    frame : array_like, (2,)
        Width and height of the image [mm]. Sites outside it count neither as open nor as in contact when
        areas are compared; default: all sites are in the image.

    Returns
    -------
    SiteMatch

    Raises
    ------
    InvalidInput
        For fewer than 3 contacts, and if fewer than 60 % of them lie on sites: they belong to another
        lattice.

    Notes
    -----
    A square lattice with its outer row open looks like a smaller lattice in two places, and
    ``SiteMatch.ambiguous`` says so unless the areas decide. Without areas, the design's middle is then placed
    as near as possible to the middle of the frame or of the contacts. Positions do not reveal whether a
    square lattice is mirrored or turned by 90°.

    Examples
    --------
    >>> x = 1.5 * np.arange(8)
    >>> sites = np.array([(a, b) for b in x for a in x])
    >>> turn = np.array([[0.998, -0.05], [0.05, 0.998]])
    >>> seen = [60, 3, 17, 40, 7, 56, 0]
    >>> found = match_sites(sites[seen] @ turn.T + 2.0, sites)
    >>> found.site.tolist(), round(found.rotation, 4), found.shift.round(6)
    ([60, 3, 17, 40, 7, 56, 0], 0.0501, array([2., 2.]))
    """
    centres = check.array("centre", centre, shape=(None, 2))
    sites = check.array("site_position", site_position, shape=(None, 2))
    refuse_if(
        viewed_from not in SIDES,
        f"viewed_from = {shown(viewed_from)} must be 'glass', if the camera looks through the glass, or "
        "'block', if it looks through the block",
    )
    bounds = Bounds(
        check.number("rotation", rotation),
        check.number("rotation_range", rotation_range, above=0.0, at_most=math.pi),
        check.number("scale_range", scale_range, above=0.0, at_most=0.5),
    )
    areas = None
    if expected_area is not None:
        refuse_if(area is None, "expected_area needs area, the measured areas of the contacts")
        areas = (
            check.array("area", area, shape=(len(centres),)),
            check.array("expected_area", expected_area, shape=(len(sites),)),
        )
    size = None if frame is None else check.array("frame", frame, shape=(2,), positive=True)
    for what, count in (("contacts", len(centres)), ("sites", len(sites))):
        must = f"cannot be matched: shift, rotation and scale need at least {FEWEST}"
        refuse_if(count < FEWEST, f"{count} {what} {must}")
    mirrored = SIDES[viewed_from]
    scene = _Scene(complex_points(centres), complex_points(sites, mirrored), bounds, mirrored, areas, size)
    coincident = "site_position holds coincident sites; each site must have a position of its own"
    refuse_if(scene.spacing == 0.0, coincident)
    poses = scene.poses()
    if not poses or poses[0].matched < max(FEWEST, ON_SITES * len(centres)):
        raise InvalidInput(scene.another_lattice(poses[:1]))
    return scene.match(poses)


@dataclass(frozen=True)
class _Scene(Search):
    """A search within bounds, seen from one side, with the measured and the expected areas."""

    bounds: Bounds
    mirrored: bool
    areas: tuple[FloatArray, FloatArray] | None
    frame: FloatArray | None

    def poses(self) -> list[Pose]:
        """Return the poses that match the largest number of contacts, the most likely first."""
        found = self.searched(self.bounds)
        return self._likeliest([*found, *self.shifted(found[0], self.bounds)] if found else [])

    def _likeliest(self, poses: list[Pose]) -> list[Pose]:
        known = {pose.site.tobytes(): pose for pose in reversed(poses)}.values()
        most = max((pose.matched for pose in known), default=0)
        best = [pose for pose in known if pose.matched == most]
        if self.areas is None:
            return sorted(best, key=self._off_centre)
        return sorted(best, key=lambda pose: -self.likely(pose))

    def _off_centre(self, pose: Pose) -> float:
        """Return the distance between the middle of the design and that of the frame or of the contacts."""
        middle = 0.5 * complex(*self.frame) if self.frame is not None else self.points.mean()
        return float(abs(pose.image(self.sites).mean() - middle))

    def likely(self, pose: Pose) -> float:
        """Return the log-likelihood of the areas under the expected ones, up to a constant.

        The areas are those of the law times one unknown factor, for an error of modulus or load, with normal
        errors of one unknown standard deviation. A site in the frame without a contact has the area 0.
        """
        assert self.areas is not None
        area, expected = self.areas
        measured: Any = np.zeros(len(expected))
        measured[pose.site[pose.site >= 0]] = area[pose.site >= 0]
        if self.frame is not None:
            place = real_points(pose.image(self.sites))
            seen = np.all((place >= 0.0) & (place <= self.frame), axis=1)
            measured, expected = measured[seen], expected[seen]
        total, own = measured @ measured, expected @ expected
        if not total or not own:
            return 0.0
        part = max(measured @ expected, 0.0) ** 2 / (total * own)
        # areas that agree to the last digit would have an infinite likelihood
        return -0.5 * len(measured) * math.log(max(1.0 - part, np.finfo(float).eps))

    def match(self, poses: list[Pose]) -> SiteMatch:
        """Return the match of the first of several poses that match equally many contacts."""
        best, matched = poses[0], poses[0].site >= 0
        away = self.points[matched] - best.image(self.sites[best.site[matched]])
        ambiguous = len(poses) > 1
        if self.areas is not None and ambiguous:
            ambiguous = not _decides(self.likely(best), self.likely(poses[1]))
        site = best.site.copy()
        site.flags.writeable = False
        return SiteMatch(
            site=site,
            shift=np.array([best.shift.real, best.shift.imag]),
            rotation=float(np.angle(best.factor)),
            scale=abs(best.factor),
            mirrored=self.mirrored,
            residual=float(np.sqrt(np.mean(np.abs(away) ** 2))),
            ambiguous=ambiguous,
            notes=tuple(self._notes(poses, ambiguous)),
        )

    def _notes(self, poses: list[Pose], ambiguous: bool) -> Iterator[Note]:
        n, best = len(poses), poses[0]
        if ambiguous:
            remedy = (
                "expected areas" if self.areas is None else "a larger load, at which more contacts close,"
            )
            yield Note(
                f"the {best.matched} contacts match the sites equally well in {n} places; {remedy} can "
                "decide between them"
            )
        elif n > 1:
            yield information(
                f"the contacts match the sites in {n} places; their areas fit one of them best, by odds "
                "of more than 100 to 1"
            )
        if self.areas is not None:
            yield from self._other_views(best)

    def _other_views(self, best: Pose) -> Iterator[Note]:
        """Return a warning if the areas are more likely from the other side or after a quarter turn."""
        own = self.likely(best)
        others: list[tuple[float, bool, int]] = []
        mirror = replace(self, sites=-self.sites.conj(), mirrored=not self.mirrored)
        for scene, first in ((self, 1), (mirror, 0)):
            for quarter in range(first, 4):
                turned = replace(best, factor=best.factor * 1j**quarter)
                rotation = self.bounds.rotation + 0.5 * math.pi * quarter
                poses = scene._likeliest(scene.shifted(turned, replace(self.bounds, rotation=rotation)))
                if poses and poses[0].matched >= best.matched:
                    others.append((scene.likely(poses[0]), scene.mirrored, 90 * quarter))
        likely, side, angle = max(others, default=(own, self.mirrored, 0))
        if not _decides(likely, own):
            return
        views = [name for name, value in SIDES.items() if value == side != self.mirrored]
        changes = [f"seen through the {name}" for name in views] + [f"turned by {angle}°"] * bool(angle)
        turn = (math.degrees(self.bounds.rotation) + angle + 180.0) % 360.0 - 180.0
        tries = [f"--viewed-from {name}" for name in views] + [f'--rotation "{turn:.4g} deg"'] * bool(angle)
        yield Note(
            f"the areas fit the design much better if it is {' and '.join(changes)}; try "
            f"{' and '.join(tries)}, and check the viewing side and the rotation of the image"
        )

    def another_lattice(self, poses: list[Pose]) -> str:
        """Return the error for contacts that are not on sites."""
        count, spacing, own = len(self.points), self.spacing, spacing_of(cKDTree(real_points(self.points)))
        apart = f"neighbours are {own:.3g} mm apart in the image and {spacing:.3g} mm in the design"
        turn, range_ = math.degrees(self.bounds.rotation), math.degrees(self.bounds.turn)
        searched = (
            f"rotations of {turn:.3g}° ± {range_:.3g}° and scales of 1 ± {self.bounds.stretch:.2g} were tried"
        )
        best = "no pair of them"
        for pose in poses:
            distance, _ = self.nearest(pose.sites(self.points), np.inf)
            median = float(np.median(distance))
            best = (
                f"at best {pose.matched} of them, and the median distance from the nearest site is "
                f"{median:.3g} mm, {100.0 * median / spacing:.0f} % of the distance between sites"
            )
        ratio = spacing / own if own else 1.0
        pixel = ""
        if abs(1.0 / ratio - 1.0) > self.bounds.stretch:
            pixel = f", which would agree if the pixels were {ratio:.3g} times as large"
        return (
            f"the {count} contacts are not on the sites of the design: {best}; {apart}{pixel}; {searched}. "
            "Check the design, the pixel size, the rotation and the viewing side"
        )


# Odds at which one of two placements is preferred: with equal prior probabilities the other one has 1 %.
ODDS = 100.0


def _decides(likely: float, other: float) -> bool:
    """Whether a log-likelihood clearly exceeds another one."""
    return likely - other >= math.log(ODDS)


@dataclass(frozen=True, eq=False, repr=False)
class SiteMatch(Value):
    """The sites of the contacts in an image.

    A site x of the design appears at ``scale R(rotation) M x + shift``, with the rotation matrix R and
    M = diag(-1, 1) if the image is mirrored, else 1.

    Attributes
    ----------
    site : ndarray of int, (n,)
        Index of the site of each contact in ``site_position``; -1 where a region lies on no site.
    shift : ndarray, (2,)
        Position of the design's origin in the image [mm].
    rotation : float
        Anticlockwise rotation of the design in the image [rad].
    scale : float
        Lengths in the image over those in the design [-].
    mirrored : bool
        Whether the image is mirrored, x -> -x, as through the block.
    residual : float
        Root mean square of the distances of the matched contacts from their sites [mm].
    ambiguous : bool
        Whether the contacts match as well with another shift, for example by one pitch.
    notes : tuple of Note

    Examples
    --------
    >>> sites = [[0.0, 0.0], [1.5, 0.0], [3.0, 0.0], [0.0, 1.5]]
    >>> from metafem.calibration import match_sites
    >>> found = match_sites([[3.5, 6.0], [3.5, 4.5], [5.0, 4.5], [6.5, 4.5]], sites)
    >>> found.site, found.shift.round(6), found.to_image([[3.0, 1.5]]).round(6)
    (array([3, 0, 1, 2]), array([3.5, 4.5]), array([[6.5, 6. ]]))
    """

    site: IntArray
    shift: FloatArray
    rotation: float
    scale: float
    mirrored: bool
    residual: float
    ambiguous: bool
    notes: tuple[Note, ...] = ()

    def to_image(self, position: ArrayLike) -> FloatArray:
        """Return the positions in the image of points of the design (m, 2) [mm]."""
        factor = self.scale * np.exp(1j * self.rotation)
        points = complex_points(np.asarray(position, dtype=np.float64), self.mirrored)
        return real_points(factor * points) + self.shift

    def to_design(self, position: ArrayLike) -> FloatArray:
        """Return the positions in the design of points of the image (m, 2) [mm]."""
        factor = self.scale * np.exp(1j * self.rotation)
        points = complex_points(np.asarray(position, dtype=np.float64) - self.shift) / factor
        return real_points(-points.conj() if self.mirrored else points)
