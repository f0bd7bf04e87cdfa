"""Matching of the contacts in one image to the sites of a design."""

from __future__ import annotations

import math
from dataclasses import dataclass

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
from metafem.notes import Note

# Sides from which the contacts may be viewed, and whether x is mirrored.
SIDES = {"glass": False, "block": True}

# Smallest number of contacts. Shift, rotation and scale are four unknowns, and three contacts have six
# coordinates.
FEWEST = 3

# Smallest fraction of the contacts that must lie on sites. If the design has two thirds or half of the true
# pitch, at most 0.45 of the contacts lie on sites.
ON_SITES = 0.6

# Largest rotation [rad] and largest relative change of scale in the search.
TURN, STRETCH = math.radians(5.0), 0.1


def match_sites(
    centre: ArrayLike,
    site_position: ArrayLike,
    *,
    viewed_from: str = "glass",
    rotation: float = 0.0,
    rotation_range: float = TURN,
    scale_range: float = STRETCH,
    frame: ArrayLike | None = None,
) -> SiteMatch:
    """Return the sites of the contacts in an image, and the shift, rotation and scale of the image.

    Pairs of contacts are compared with pairs of sites. Each similarity (shift, rotation and scale) that maps
    a pair of sites to a pair of contacts is rated by the number of contacts near sites. The best similarities
    are refined by least squares. There may be open contacts, regions that are not contacts, and sites outside
    the frame.

    Parameters
    ----------
    centre : array_like, (n, 2)
        Centres of the contacts in the image [mm], x to the right and y upwards; at least 3.
    site_position : array_like, (m, 2)
        Positions of at least 3 sites of the design [mm], in any arrangement, as in `heights.csv`: viewed from
        above the asperities.
    viewed_from : {"glass", "block"}
        "glass": the camera looks through the glass at the summits, and x and y are those of heights.csv.
        "block": the camera looks through the base of the block, and the image is mirrored (x -> -x), like
        mould.csv. If the optics or the camera's software mirror the image, exchange the two values. Default:
        "glass".
    rotation : float
        Approximate rotation of the design in the image, anticlockwise [rad]; default: 0.
    rotation_range : float
        Largest difference from `rotation` [rad]; default: 5°. It must be less than 45° for a square lattice.
    scale_range : float
        Largest relative error of the pixel size [-]; default: 0.1.
    frame : array_like, (2,)
        Width and height of the image [mm]; default: none. If several shifts match equally many contacts, the
        one that puts the centre of the design nearest to the centre of the frame is used, or of the contacts
        without a frame.

    Returns
    -------
    SiteMatch

    Raises
    ------
    InvalidInput
        If there are fewer than 3 contacts, or if fewer than 60 % of the contacts lie on sites.

    Notes
    -----
    If an outer row of a square lattice is open, the remaining contacts match two positions of the lattice.
    Then ``SiteMatch.ambiguous`` is true, and a note says so.
    Positions do not show whether a square lattice is mirrored or turned by 90°.

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
    size = None if frame is None else check.array("frame", frame, shape=(2,), positive=True)
    for what, count in (("contacts", len(centres)), ("sites", len(sites))):
        must = f"cannot be matched: shift, rotation and scale need at least {FEWEST}"
        refuse_if(count < FEWEST, f"{count} {what} {must}")
    mirrored = SIDES[viewed_from]
    scene = _Scene(complex_points(centres), complex_points(sites, mirrored), bounds, mirrored, size)
    coincident = "site_position holds coincident sites; each site must have a position of its own"
    refuse_if(scene.spacing == 0.0, coincident)
    poses = scene.poses()
    if not poses or poses[0].matched < max(FEWEST, ON_SITES * len(centres)):
        raise InvalidInput(scene.another_lattice(poses[:1]))
    return scene.match(poses)


@dataclass(frozen=True)
class _Scene(Search):
    """Search within bounds for one viewing side."""

    bounds: Bounds
    mirrored: bool
    frame: FloatArray | None

    def poses(self) -> list[Pose]:
        """Return the poses that match the largest number of contacts, the most central pose first."""
        found = self.searched(self.bounds)
        return self._most([*found, *self.shifted(found[0], self.bounds)] if found else [])

    def _most(self, poses: list[Pose]) -> list[Pose]:
        known = {pose.site.tobytes(): pose for pose in reversed(poses)}.values()
        most = max((pose.matched for pose in known), default=0)
        best = [pose for pose in known if pose.matched == most]
        return sorted(best, key=self._off_centre)

    def _off_centre(self, pose: Pose) -> float:
        """Return the distance [mm] of the design's centre from the centre of the frame or of the contacts."""
        middle = 0.5 * complex(*self.frame) if self.frame is not None else self.points.mean()
        return float(abs(pose.image(self.sites).mean() - middle))

    def match(self, poses: list[Pose]) -> SiteMatch:
        """Return the match for the first pose; all poses match equally many contacts."""
        best, matched = poses[0], poses[0].site >= 0
        away = self.points[matched] - best.image(self.sites[best.site[matched]])
        ambiguous = len(poses) > 1
        many = f"the {best.matched} contacts match the sites equally well in {len(poses)} places; a larger "
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
            notes=(Note(f"{many}load, at which more contacts close, can decide between them"),) * ambiguous,
        )

    def another_lattice(self, poses: list[Pose]) -> str:
        """Return the error message for contacts that are not on sites."""
        count, spacing, own = len(self.points), self.spacing, spacing_of(cKDTree(real_points(self.points)))
        apart = f"neighbours are {own:.3g} mm apart in the image and {spacing:.3g} mm in the design"
        best = f"at best {poses[0].matched} of them" if poses else "no pair of them"
        ratio = spacing / own if own else 1.0
        pixel = ""
        if abs(1.0 / ratio - 1.0) > self.bounds.stretch:
            pixel = f", which would agree if the pixels were {ratio:.3g} times as large"
        return (
            f"the {count} contacts are not on the sites of the design: {best}; {apart}{pixel}. "
            "Check the design, the pixel size, the rotation and the viewing side"
        )


@dataclass(frozen=True, eq=False, repr=False)
class SiteMatch(Value):
    """Sites of the contacts in an image, and the map from the design to the image.

    A site x of the design appears at ``scale R(rotation) M x + shift``, with the rotation matrix R and
    M = diag(-1, 1) if the image is mirrored, else 1.

    Attributes
    ----------
    site : ndarray of int, (n,)
        Index of each contact's site in ``site_position``; -1 if the region lies on no site.
    shift : ndarray, (2,)
        Position of the design's origin in the image [mm].
    rotation : float
        Anticlockwise rotation of the design in the image [rad].
    scale : float
        Ratio of lengths in the image to lengths in the design [-].
    mirrored : bool
        Whether the image is mirrored (x -> -x), as in a view through the block.
    residual : float
        Root mean square distance of the matched contacts from their sites [mm].
    ambiguous : bool
        Whether another shift, for example by one pitch, matches equally well.
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
        """Return the positions in the image [mm], (m, 2), of points of the design."""
        factor = self.scale * np.exp(1j * self.rotation)
        points = complex_points(np.asarray(position, dtype=np.float64), self.mirrored)
        return real_points(factor * points) + self.shift

    def to_design(self, position: ArrayLike) -> FloatArray:
        """Return the positions in the design [mm], (m, 2), of points of the image."""
        factor = self.scale * np.exp(1j * self.rotation)
        points = complex_points(np.asarray(position, dtype=np.float64) - self.shift) / factor
        return real_points(-points.conj() if self.mirrored else points)
