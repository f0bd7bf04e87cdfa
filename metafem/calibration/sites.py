"""Contacts in images matched to the sites of a design, and followed through the images of one sample.

Points of the plane are complex numbers x + iy, so that a rotation and a scale are one factor.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.calibration.contact_table import contact_table, listed
from metafem.calibration.images import ContactAreas
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note

if TYPE_CHECKING:
    from pandas import DataFrame

Points = NDArray[np.complex128]

# Sides from which the contacts may be viewed, and whether x is mirrored.
SIDES = {"glass": False, "block": True}

# Smallest number of contacts. Shift, rotation and scale are four unknowns, and three contacts have six
# coordinates.
FEWEST = 3

# Smallest fraction of the contacts that must lie on sites. If the design has two thirds or half of the true
# pitch, at most 0.45 of the contacts lie on sites.
ON_SITES = 0.6

# Largest rotation [rad] and largest relative change of scale in the search, and the factor that widens both
# during the search, because short pairs have large errors.
TURN, STRETCH, SLACK = math.radians(5.0), 0.1, 1.2

# Largest distance between a contact and the image of its site, over the distance between neighbouring sites:
# during the search, so that a contact is near one site only, and at its end, for errors of a few pixels. At
# the end it is MEDIANS times the median distance, about 7 standard deviations of normal errors.
REACH, LEAST_REACH, MEDIANS = 0.2, 0.02, 6.0

# Largest length of a pair of contacts, over the distance between neighbouring sites. Long pairs have small
# errors of direction, but open contacts make many long pairs useless.
LONGEST = 6.0

# Number of compared pairs of contacts, number of contacts that rate a similarity, and number of refined
# similarities. If a fifth of the regions are not contacts, a third of the pairs are useless.
PAIRS, RATING, REFINED = 30, 40, 24

# Largest number of steps of a refinement; three or four usually suffice.
STEPS = 20


class Pose(NamedTuple):
    """Similarity w -> factor w + shift of the sites to the image, and the site of each contact, -1: none."""

    factor: complex
    shift: complex
    site: IntArray

    @property
    def matched(self) -> int:
        """Number of contacts that have a site."""
        return int(np.count_nonzero(self.site >= 0))


def complex_points(points: Any, mirrored: bool = False) -> Points:
    """Return points (n, 2) as complex numbers x + iy, or -x + iy if mirrored, (n,)."""
    x, y = np.asarray(points, dtype=np.float64).reshape(-1, 2).T
    return np.asarray((-x if mirrored else x) + 1j * y, dtype=np.complex128)


def real_points(points: Any) -> FloatArray:
    """Return complex numbers (n,) as points (n, 2)."""
    return np.column_stack([np.real(points), np.imag(points)])


def similarity(points: Points, sites: Points) -> tuple[complex, complex]:
    """Return factor and shift with the least squares of ``points - factor sites - shift``."""
    middle, origin = points.mean(), sites.mean()
    away = sites - origin
    factor = np.vdot(away, points - middle) / np.vdot(away, away).real
    return complex(factor), complex(middle - factor * origin)


class Sites:
    """The sites of a design in any arrangement, on which the contacts of an image are sought."""

    def __init__(self, sites: Points) -> None:
        self.sites, self.tree = sites, cKDTree(real_points(sites))
        self.spacing = _spacing(self.tree)

    def assigned(self, points: Points, factor: complex, shift: complex, reach: float) -> Any:
        """Return the site of each contact, -1 for none, and its distance; a site has one contact at most."""
        where = real_points((points - shift) / factor)
        distance, nearest = self.tree.query(where, distance_upper_bound=reach)
        site = np.full(len(points), -1, dtype=np.intp)
        order = np.argsort(distance, kind="stable")
        order = order[np.isfinite(distance[order])]
        chosen = order[np.unique(nearest[order], return_index=True)[1]]
        site[chosen] = nearest[chosen]
        return site, distance

    def refined(self, points: Points, factor: complex, shift: complex, rigid: bool = False) -> Pose:
        """Return the pose that fits the contacts near sites; if `rigid`, only the shift is fitted."""
        widest = REACH * self.spacing
        site, _ = self.assigned(points, factor, shift, 0.5 * self.spacing if rigid else widest)
        for _ in range(STEPS):
            on = site >= 0
            if on.sum() < 2 - rigid:
                break
            if rigid:
                away = points[on] - self.sites[site[on]]
                shift = complex(np.median(away.real), np.median(away.imag))
            else:
                factor, shift = similarity(points[on], self.sites[site[on]])
            before, (site, distance) = site, self.assigned(points, factor, shift, widest)
            near = distance[np.isfinite(distance)]
            reach = max(MEDIANS * float(np.median(near)) if near.size else 0.0, LEAST_REACH * self.spacing)
            site, _ = self.assigned(points, factor, shift, min(reach, widest))
            if np.array_equal(site, before):
                break
        return Pose(factor, shift, site)

    def search(self, points: Points, rotations: Sequence[float], turn: float) -> list[Pose]:
        """Return the different poses with the most matched contacts, near one of the rotations.

        They map a pair of sites to a pair of contacts, or then a site to the most central matched contact.
        """
        poses: list[Pose] = []
        for rotation in rotations:
            found = self._best(points, *self._pairs(points), rotation, turn)
            if found:
                best = max(found, key=lambda pose: pose.matched)
                matched = points[best.site >= 0]
                middle = matched[np.argmin(np.abs(matched - matched.mean()))]
                factor = np.full(len(self.sites), best.factor)
                found += self._best(points, factor, middle - factor * self.sites, rotation, turn)
            poses += found
        most = max((pose.matched for pose in poses), default=0)
        if most < max(FEWEST, ON_SITES * len(points)):
            own = _spacing(cKDTree(real_points(points)))
            raise InvalidInput(
                f"{len(points)} contacts or caps are not on the sites of the design: at best {most} of them; "
                f"neighbours are {own:.3g} mm apart, and {self.spacing:.3g} mm in the design. Check the "
                "design, the pixel size, the rotation and the viewing side"
            )
        different = {pose.site.tobytes(): pose for pose in reversed(poses) if pose.matched == most}
        return list(different.values())[::-1]

    def _pairs(self, points: Points) -> tuple[Points, Points]:
        """Return factors and shifts of the similarities that map a pair of sites to a pair of contacts."""
        first, second = _near_pairs(cKDTree(real_points(points)), LONGEST * self.spacing)
        long = np.flatnonzero(np.abs(points[second] - points[first]) > REACH * self.spacing)
        chosen = long[np.unique(np.linspace(0, len(long) - 1, min(PAIRS, len(long))).astype(int))]
        one, two = _near_pairs(self.tree, SLACK * LONGEST * self.spacing)
        site, other = np.append(one, two), np.append(two, one)
        between = points[second[chosen]] - points[first[chosen]]
        factor = between[:, None] / (self.sites[other] - self.sites[site])
        return factor.ravel(), (points[first[chosen], None] - factor * self.sites[site]).ravel()

    def _best(
        self, points: Points, factor: Points, shift: Points, rotation: float, turn: float
    ) -> list[Pose]:
        """Return the refined poses of the similarities with the most contacts near sites."""
        admitted = _admitted(factor, rotation, turn)
        factor, shift = factor[admitted], shift[admitted]
        some = points[np.unique(np.linspace(0, len(points) - 1, RATING).astype(int))]
        where = ((some - shift[:, None]) / factor[:, None]).ravel()
        reach = REACH * self.spacing
        distance, _ = self.tree.query(real_points(where), distance_upper_bound=reach)
        near = np.maximum(1.0 - (distance / reach) ** 2, 0.0).reshape(-1, len(some)).sum(axis=1)
        best = np.argsort(-near, kind="stable")[:REFINED]
        found = [self.refined(points, complex(factor[i]), complex(shift[i])) for i in best]
        return [pose for pose in found if pose.matched > 1 and _admitted(pose.factor, rotation, turn)]


def _admitted(factor: Any, rotation: float, turn: float) -> Any:
    """Return whether similarities are within the ranges of rotation and scale of the search."""
    angle = np.abs(np.angle(factor * np.exp(-1j * rotation)))
    return (angle <= SLACK * turn) & (np.abs(np.abs(factor) - 1.0) <= SLACK * STRETCH)


def _spacing(tree: Any) -> float:
    """Return the median distance between nearest neighbours in a tree; infinite for one point."""
    return float(np.median(tree.query(tree.data, k=2)[0][:, 1]))


def _near_pairs(tree: Any, reach: float) -> tuple[IntArray, IntArray]:
    """Return the pairs of points closer than `reach`, in a reproducible order."""
    pairs = tree.query_pairs(reach, output_type="ndarray")
    pairs = pairs[np.lexsort(pairs.T[::-1])]
    return pairs[:, 0], pairs[:, 1]


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

    def to_image(self, position: ArrayLike) -> FloatArray:
        """Return the positions in the image [mm], (m, 2), of points of the design."""
        factor = self.scale * np.exp(1j * self.rotation)
        return real_points(factor * complex_points(position, self.mirrored)) + self.shift


def match_sites(
    centre: ArrayLike,
    site_position: ArrayLike,
    *,
    viewed_from: str = "glass",
    rotation: float = 0.0,
) -> SiteMatch:
    """Return the sites of the contacts in an image, and the shift, rotation and scale of the image.

    Pairs of contacts are compared with pairs of sites. Each similarity (shift, rotation, and scale from 0.9
    to 1.1) that maps a pair of sites to a pair of contacts is rated by the number of contacts near sites. The
    best similarities are refined by least squares. There may be open contacts, regions that are not contacts,
    and sites outside the frame.

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
        Rotation of the design in the image, anticlockwise, to within 5° [rad]; default: 0.

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
    Then ``SiteMatch.ambiguous`` is true, and the one with the design about the contacts is used. Positions
    do not show whether a square lattice is mirrored or turned by 90°.

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
    places = check.array("site_position", site_position, shape=(None, 2))
    must = "must be 'glass', if the camera looks through the glass, or 'block', if it looks through the block"
    refuse_if(viewed_from not in SIDES, f"viewed_from = {shown(viewed_from)} {must}")
    angle = check.number("rotation", rotation)
    for what, count in (("contacts", len(centres)), ("sites", len(places))):
        few = f"{count} {what} cannot be matched: shift, rotation and scale need at least {FEWEST}"
        refuse_if(count < FEWEST, few)
    mirrored = SIDES[viewed_from]
    points, design = complex_points(centres), Sites(complex_points(places, mirrored))
    coincident = "site_position holds coincident sites; each site must have a position of its own"
    refuse_if(design.spacing == 0.0, coincident)
    most = design.search(points, [angle], TURN)
    # of several places, the one at which the design is about the contacts
    best = min(most, key=lambda one: abs((one.factor * design.sites + one.shift).mean() - points.mean()))
    matched = best.site >= 0
    away = points[matched] - best.factor * design.sites[best.site[matched]] - best.shift
    return SiteMatch(
        site=best.site,
        shift=real_points([best.shift])[0],
        rotation=float(np.angle(best.factor)),
        scale=abs(best.factor),
        mirrored=mirrored,
        residual=float(np.sqrt(np.mean(np.abs(away) ** 2))),
        ambiguous=len(most) > 1,
    )


class Placed(NamedTuple):
    """Sites in an image: their positions (m, 2) [mm], the site of each contact (n,), -1 if it has none, and
    the sites that could not be measured (m,): at the edge, outside the frame, merged, or beside a contact.
    """

    position: FloatArray
    site: IntArray
    unmeasured: NDArray[np.bool_]

    def of(self, kept: NDArray[np.bool_]) -> Placed:
        """Return the sites that are kept (m,), numbered anew."""
        number = np.append(np.where(kept, np.cumsum(kept) - 1, -1), -1)
        return Placed(self.position[kept], number[self.site], self.unmeasured[kept])


class TrackedContacts(NamedTuple):
    """Contacts of a stack of images.

    Attributes
    ----------
    table : DataFrame
        One row for each image and contact, as `contact_table` returns it.
    name : str
        Name of the reference image, whose contacts were matched to the sites or, without sites, numbered.
    match : SiteMatch or None
        Match of the reference image; None without sites.
    placed : dict of Placed
        Sites in each image that could be measured, by its name.
    notes : list of Note

    Examples
    --------
    >>> import pandas as pd, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> image = 200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - 20.0))
    >>> areas = {"1.tif": mf.calibration.contact_areas(image, 0.005)}
    >>> forces = pd.DataFrame({"image": ["1.tif"], "sheared_image": "", "test": "", "load": 0.05})
    >>> found = mf.calibration.track_contacts(areas, forces.assign(friction_force=0.1))
    >>> found.name, found.match, found.placed["1.tif"].site, found.notes
    ('1.tif', None, array([0]), [])
    """

    table: DataFrame
    name: str
    match: SiteMatch | None
    placed: dict[str, Placed]
    notes: list[Note]


def track_contacts(
    areas: Mapping[str, ContactAreas | None],
    forces: DataFrame,
    *,
    site_position: ArrayLike | None = None,
    site_number: ArrayLike | None = None,
    viewed_from: str = "glass",
    rotation: float = 0.0,
) -> TrackedContacts:
    """Return the contacts of one sample, identified in all its images, and their areas.

    `match_sites` matches the reference image, the image with a load that has the most contacts, to the sites
    of the design. Without sites, the contacts of the reference are numbered, including contacts at its edge
    that are complete in another image. Between two images the sample moves by less than half the distance
    between neighbouring sites; a note names images with contacts on no site. A site without a contact is
    open: its area is 0. A site that is outside the frame, at the edge of the frame or has a merged contact
    has the area nan.

    Parameters
    ----------
    areas : mapping of str to ContactAreas or None
        Contacts of the images by their names; an image that is None has the areas nan.
    forces : DataFrame, (k,)
        Columns ``image`` (names, all different), ``sheared_image`` (names of images at the peak of the
        friction force, or ""), ``test`` (names), ``load`` and ``friction_force`` [N], nan where unknown.
    site_position : array_like, (m, 2), optional
        Positions of the sites of the design [mm]; default: none, the contacts are numbered.
    site_number : array_like of int, (m,), optional
        Their numbers; default: 0 to m - 1, as in heights.csv.
    viewed_from, rotation : str, float
        As for `match_sites`.

    Returns
    -------
    TrackedContacts

    Raises
    ------
    InvalidInput
        If no image shows a contact, or if the image with the most contacts, which the error names, does not
        match the sites.

    Examples
    --------
    >>> import numpy as np, pandas as pd, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> image = 200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - 20.0))
    >>> areas = {"1.tif": mf.calibration.contact_areas(image, 0.005)}
    >>> forces = pd.DataFrame({"image": ["1.tif"], "sheared_image": "", "test": "", "load": 0.05})
    >>> table = track_contacts(areas, forces.assign(friction_force=np.nan)).table
    >>> table[["image", "load", "contact", "area"]].round(3).values.tolist()
    [['1.tif', 0.05, 1, 0.032]]
    """
    names, sheared = forces["image"].tolist(), forces["sheared_image"].tolist()
    unknown = dict(zip(names, forces["load"].isna(), strict=True))
    complete = {name: int(one.complete.sum()) for name in names if (one := areas[name]) is not None}
    usable = [name for name, count in complete.items() if count]
    refuse_if(not usable, f"no contact can be measured in {listed(names) or 'an empty list of images'}")
    reference = min(usable, key=lambda name: (unknown[name], -complete[name]))
    first: Any = areas[reference]
    match, number, notes = None, None, []
    if site_position is None:
        known = first.complete | first.edge
        position, cut = first.centre[known], first.edge[known]
        where = position
    else:
        position = check.array("site_position", site_position, shape=(None, 2))
        number = np.arange(len(position)) if site_number is None else np.asarray(site_number)
        try:
            match = match_sites(
                first.centre[first.complete], position, viewed_from=viewed_from, rotation=rotation
            )
        except InvalidInput as error:
            raise InvalidInput(f"{reference}: {error}") from None
        where, cut = match.to_image(position), np.zeros(len(position), dtype=bool)
        text = f"{reference}: the contacts match the sites equally well in several places; an image in which"
        notes += [Note(f"{text} more contacts close can decide")] * match.ambiguous
    placed: dict[str, Placed] = {}
    for pair in zip(names, sheared, strict=True):
        before = where
        for name in pair:
            one = areas.get(name)
            if one is not None:
                placed[name] = _placed(one, before, cut)
                before = placed[name].position
                strays = int((placed[name].site[one.complete] < 0).sum())
                text = f"{name}: {strays} regions are on no site; dust, or the sample moved too far"
                notes += [Note(text)] * (strays > 0)
    columns = [*_at_sites(areas, placed, names, len(where)), *_at_sites(areas, placed, sheared, len(where))]
    if match is None:  # a contact at the edge has a number if another image shows all of it
        seen: Any = (columns[0] > 0.0).any(axis=0) | (columns[2] > 0.0).any(axis=0)
        position, columns = position[seen], [column[:, seen] for column in columns]
        placed = {name: one.of(seen) for name, one in placed.items()}
    return TrackedContacts(contact_table(forces, position, number, *columns), reference, match, placed, notes)


def _placed(areas: ContactAreas, position: FloatArray, cut: NDArray[np.bool_]) -> Placed:
    """Return the sites in an image, from their positions in another image [mm].

    The positions of contacts that the edge has `cut` there (m,) are those of what is seen of them.
    """
    sites, points = Sites(complex_points(position)), complex_points(areas.centre[areas.complete])
    pose = sites.refined(points, 1.0, 0.0, True)
    near, _ = sites.assigned(points, 1.0, pose.shift, REACH * sites.spacing)
    where = position + real_points([pose.shift])
    site = np.full(areas.count, -1, dtype=np.intp)
    site[areas.complete] = np.where(np.append(cut, False)[near], near, pose.site)
    unmeasured = np.any((where < 0.0) | (where > areas.frame), axis=1)
    for region in np.flatnonzero(site < 0):
        away = complex_points(where - areas.centre[region]) * np.exp(-1j * areas.angle[region])
        unmeasured |= np.hypot(*(real_points(away) / areas.axes[region]).T) <= 1.0
    unmeasured[site[site >= 0]] = False
    return Placed(where, site, unmeasured)


def _at_sites(
    areas: Mapping[str, ContactAreas | None], placed: dict[str, Placed], names: list[str], count: int
) -> tuple[FloatArray, FloatArray]:
    """Return areas at sites and their errors, (k, m); the error of an open site is the smallest area."""
    area, error = np.full((2, len(names), count), np.nan)
    for i, name in enumerate(names):
        one = areas.get(name)
        if one is not None:
            site, unmeasured = placed[name].site, placed[name].unmeasured
            on = site >= 0
            area[i], error[i] = np.where(unmeasured, np.nan, [[0.0], [one.smallest_area]])
            area[i, site[on]], error[i, site[on]] = one.area[on], one.area_error[on]
    return area, error
