"""Contacts in images matched to the sites of a design, and followed through the images of one sample.

Points of the plane are complex numbers x + iy, so that a rotation and a scale are one factor.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from metafem import _validate as check
from metafem._given import printable, shown
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.calibration.contact_table import ContactTable
from metafem.calibration.images import ContactAreas, contact_notes
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note

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

# Number of regions from which the shift of an image is guessed; at least one of them is assumed a contact.
GUESSES = 8

# A shift by more than HALF the distance between sites is used only if it matches clearly more regions than a
# shorter one: MORE regions and the fraction PART of all. A shift below CERTAIN of the distance is certain.
HALF, CERTAIN, MORE, PART = 0.5, 0.4, 3, 0.1

# Largest distance between a region at the edge of the frame and its site, in semi-axes of the region. The
# distance is 0.8 for half a circle, and larger if less of the circle is visible. Other regions contain their
# sites.
SEMI_AXES = 1.5


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


@dataclass(frozen=True)
class _Search:
    """Search for the similarity that maps sites, in any arrangement, to the contacts of an image."""

    points: Points
    sites: Points

    @cached_property
    def tree(self) -> Any:
        """Search tree of the positions of the sites."""
        return cKDTree(real_points(self.sites))

    @cached_property
    def spacing(self) -> float:
        """Median distance between nearest neighbours among the sites [mm]."""
        return _spacing(self.tree)

    def reach(self, distance: FloatArray | None = None) -> float:
        """Return the largest distance of a contact from its site [mm], based on the distances if known."""
        widest = REACH * self.spacing
        if distance is None or not distance.size:
            return widest
        return min(max(MEDIANS * float(np.median(distance)), LEAST_REACH * self.spacing), widest)

    def assigned(self, factor: complex, shift: complex, reach: float) -> tuple[IntArray, FloatArray]:
        """Return the site of each contact, -1 for none, and its distance; a site has one contact at most."""
        where = real_points((self.points - shift) / factor)
        distance, nearest = self.tree.query(where, distance_upper_bound=reach)
        site = np.full(len(self.points), -1, dtype=np.intp)
        order = np.argsort(distance, kind="stable")
        order = order[np.isfinite(distance[order])]
        chosen = order[np.unique(nearest[order], return_index=True)[1]]
        site[chosen] = nearest[chosen]
        return site, distance

    def best(self, factor: Points, shift: Points, most: int) -> list[int]:
        """Return the similarities with the most contacts near sites, weighted by distance."""
        some = self.points[np.unique(np.linspace(0, len(self.points) - 1, RATING).astype(int))]
        where = ((some - shift[:, None]) / factor[:, None]).ravel()
        distance, _ = self.tree.query(real_points(where), distance_upper_bound=self.reach())
        rated = np.maximum(1.0 - (distance / self.reach()) ** 2, 0.0).reshape(len(shift), -1).sum(axis=1)
        return [int(i) for i in np.argsort(-rated, kind="stable")[:most]]

    def similar(self, rotation: float, turn: float) -> list[Pose]:
        """Return the poses of a search by pairs and by shifts, sorted by the number of matched contacts."""
        factor, shift = self._pairs(rotation, turn)
        found = self._poses(factor, shift, rotation, turn)
        if found:
            # any shift of one of the sites to the most central of the matched contacts
            matched = self.points[found[0].site >= 0]
            middle = matched[np.argmin(np.abs(matched - matched.mean()))]
            factor = np.full(len(self.sites), found[0].factor)
            found += self._poses(factor, middle - factor * self.sites, rotation, turn)
        different = {pose.site.tobytes(): pose for pose in reversed(found)}.values()
        return sorted(different, key=lambda pose: -pose.matched)

    def _pairs(self, rotation: float, turn: float) -> tuple[Points, Points]:
        """Return the factors and shifts of similarities that map a pair of sites to a pair of contacts."""
        points = self.points
        first, second = _near_pairs(cKDTree(real_points(points)), LONGEST * self.spacing)
        long = np.flatnonzero(np.abs(points[second] - points[first]) > REACH * self.spacing)
        chosen = long[np.unique(np.linspace(0, len(long) - 1, PAIRS).astype(int))] if long.size else long
        one, two = _near_pairs(self.tree, SLACK * LONGEST * self.spacing)
        site, other = np.concatenate([one, two]), np.concatenate([two, one])
        between = points[second[chosen]] - points[first[chosen]]
        factor = between[:, None] / (self.sites[other] - self.sites[site])
        shift = points[first[chosen], None] - factor * self.sites[site]
        admitted = _admitted(factor, rotation, turn)
        return factor[admitted], shift[admitted]

    def _poses(self, factor: Points, shift: Points, rotation: float, turn: float) -> list[Pose]:
        """Return the refined poses of the best similarities, sorted by the number of matched contacts."""
        best = self.best(factor, shift, REFINED) if factor.size else []
        refined = [self._refined(complex(factor[i]), complex(shift[i])) for i in best]
        found = [pose for pose in refined if pose.matched > 1 and _admitted(pose.factor, rotation, turn)]
        return sorted(found, key=lambda pose: -pose.matched)

    def _refined(self, factor: complex, shift: complex) -> Pose:
        """Return the least-squares pose of the contacts near sites."""
        site, _ = self.assigned(factor, shift, self.reach())
        for _ in range(20):  # three or four steps usually suffice
            matched = site >= 0
            if np.count_nonzero(matched) < 2:
                break
            factor, shift = similarity(self.points[matched], self.sites[site[matched]])
            _, distance = self.assigned(factor, shift, self.reach())
            before = site
            site, _ = self.assigned(factor, shift, self.reach(distance[np.isfinite(distance)]))
            if np.array_equal(site, before):
                break
        return Pose(factor, shift, site)


def similarity(points: Points, sites: Points) -> tuple[complex, complex]:
    """Return factor and shift with the least squares of ``points - factor sites - shift``."""
    middle, origin = points.mean(), sites.mean()
    away = sites - origin
    factor = np.vdot(away, points - middle) / np.vdot(away, away).real
    return complex(factor), complex(middle - factor * origin)


def _admitted(factor: Any, rotation: float, turn: float) -> Any:
    """Return whether similarities are within the ranges of rotation and scale of the search."""
    angle = np.abs(np.angle(factor * np.exp(-1j * rotation)))
    return (angle <= SLACK * turn) & (np.abs(np.abs(factor) - 1.0) <= SLACK * STRETCH)


def _spacing(tree: Any) -> float:
    """Return the median distance between nearest neighbours in a tree."""
    return float(np.median(tree.query(tree.data, k=2)[0][:, 1]))


def _near_pairs(tree: Any, reach: float) -> tuple[IntArray, IntArray]:
    """Return the pairs of points closer than `reach`, in a reproducible order."""
    pairs = tree.query_pairs(reach, output_type="ndarray")
    pairs = pairs[np.lexsort(pairs.T[::-1])]
    return pairs[:, 0], pairs[:, 1]


def match_sites(
    centre: ArrayLike,
    site_position: ArrayLike,
    *,
    viewed_from: str = "glass",
    rotation: float = 0.0,
    rotation_range: float = TURN,
    frame: ArrayLike | None = None,
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
        Approximate rotation of the design in the image, anticlockwise [rad]; default: 0.
    rotation_range : float
        Largest difference from `rotation` [rad]; default: 5°. It must be less than 45° for a square lattice.
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
    must = "must be 'glass', if the camera looks through the glass, or 'block', if it looks through the block"
    refuse_if(viewed_from not in SIDES, f"viewed_from = {shown(viewed_from)} {must}")
    angle = check.number("rotation", rotation)
    turn = check.number("rotation_range", rotation_range, above=0.0, at_most=math.pi)
    size = None if frame is None else check.array("frame", frame, shape=(2,), positive=True)
    for what, count in (("contacts", len(centres)), ("sites", len(sites))):
        few = f"{count} {what} cannot be matched: shift, rotation and scale need at least {FEWEST}"
        refuse_if(count < FEWEST, few)
    mirrored = SIDES[viewed_from]
    points = complex_points(centres)
    search = _Search(points, complex_points(sites, mirrored))
    coincident = "site_position holds coincident sites; each site must have a position of its own"
    refuse_if(search.spacing == 0.0, coincident)
    poses = search.similar(angle, turn)
    if not poses or poses[0].matched < max(FEWEST, ON_SITES * len(points)):
        raise InvalidInput(_elsewhere(search, poses[0].matched if poses else 0))
    middle = 0.5 * complex(*size) if size is not None else points.mean()
    most = [pose for pose in poses if pose.matched == poses[0].matched]
    best = min(most, key=lambda pose: abs((pose.factor * search.sites + pose.shift).mean() - middle))
    matched = best.site >= 0
    away = points[matched] - best.factor * search.sites[best.site[matched]] - best.shift
    text = (
        f"the {best.matched} contacts match the sites equally well in {len(most)} places; a larger load, at "
        "which more contacts close, can decide between them"
    )
    best.site.flags.writeable = False
    return SiteMatch(
        site=best.site,
        shift=np.array([best.shift.real, best.shift.imag]),
        rotation=float(np.angle(best.factor)),
        scale=abs(best.factor),
        mirrored=mirrored,
        residual=float(np.sqrt(np.mean(np.abs(away) ** 2))),
        ambiguous=len(most) > 1,
        notes=(Note(text),) * (len(most) > 1),
    )


def _elsewhere(search: _Search, matched: int) -> str:
    """Return the error message for contacts that are not on sites."""
    count, spacing = len(search.points), search.spacing
    own = _spacing(cKDTree(real_points(search.points)))
    ratio = spacing / own if own else 1.0
    agree = f", which would agree if the pixels were {ratio:.3g} times as large"
    pixel = agree if abs(1.0 / ratio - 1.0) > STRETCH else ""
    return (
        f"the {count} contacts are not on the sites of the design: at best {matched} of them; neighbours are "
        f"{own:.3g} mm apart in the image and {spacing:.3g} mm in the design{pixel}. Check the design, the "
        "pixel size, the rotation and the viewing side"
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
        return real_points(factor * complex_points(position, self.mirrored)) + self.shift


def track_contacts(
    areas: Sequence[ContactAreas],
    image: Sequence[str],
    *,
    test: Sequence[str] | None = None,
    load: ArrayLike | None = None,
    friction_force: ArrayLike | None = None,
    sheared: Sequence[ContactAreas | None] | None = None,
    sites: DesignSites | None = None,
) -> TrackedContacts:
    """Return the contacts of one sample, identified in all its images, and their areas.

    `match_sites` matches the reference image, the image with the most contacts, to the sites of the design.
    If loads are passed, the reference is an image with a load. In each other image, the sites are located by
    the shift that matches the most contacts. If `sites` is None, the contacts of the reference serve as
    sites, including contacts at its edge that are complete in another image. The shortest shift is used,
    unless a longer shift matches clearly more contacts; a warning names the images for which this is unclear.
    A site without a contact is open: its area is 0. A site that is outside the frame, at the edge of the
    frame or has a merged contact has the area nan and a remark.

    Parameters
    ----------
    areas : sequence of ContactAreas, (k,)
        Contacts of the images from `stack_areas`. An image that ``failed`` has the areas nan.
    image : sequence of str, (k,)
        Names of the images, all different.
    test : sequence of str, (k,), optional
        Name of each image's test; default: none.
    load, friction_force : array_like, (k,), optional
        Normal load and friction force of each image [N]; nan where unknown; default: all unknown.
    sheared : sequence of ContactAreas or None, (k,), optional
        Contacts of the images at the peak of the friction force; default: none.
    sites : DesignSites, optional
        Sites of the design and viewing side; default: none, the contacts are numbered.

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
    >>> import numpy as np, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> image = 200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - 20.0))
    >>> stack = [image, np.roll(image, 3, axis=1)]
    >>> areas = [mf.calibration.contact_areas(one, 0.005) for one in stack]
    >>> table = track_contacts(areas, ["1.tif", "2.tif"], load=[0.05, 0.05]).table
    >>> table.area.round(3).tolist(), table.load
    ([[0.032], [0.032]], array([0.05, 0.05]))
    """
    found, names = tuple(areas), tuple(map(str, image))
    k = len(found)
    for one in found:
        check.instance("areas", one, ContactAreas, "ContactAreas, as stack_areas returns them")
    tests = ("",) * k if test is None else tuple(map(str, test))
    others = (None,) * k if sheared is None else tuple(sheared)
    for name, values in (("image", names), ("test", tests), ("sheared", others)):
        refuse_if(len(values) != k, f"{name} holds {len(values)} entries; areas holds {k}")
    for i, twice in enumerate(names):
        must = f"image holds {printable(twice, 60)} twice; names of images must differ"
        refuse_if(twice in names[:i], must)
    loads, forces = (
        np.full(k, np.nan) if values is None else check.array_with_gaps(name, values, shape=(k,))
        for name, values in (("load", load), ("friction_force", friction_force))
    )
    reference = _fullest(found, names, loads)
    match = None
    if sites is None:
        first = found[reference]
        # a region at the edge counts if another image shows all of it; its semi-axis is the error of its
        # centre
        known = np.flatnonzero(first.complete | first.edge)
        reach = np.where(first.edge, first.axes[:, 0], 0.0)
        placed = _placed(first.centre[known], found, others, reach[known])
        seen = [one.site for one in placed[0] if one is not None]
        known = known[np.isin(np.arange(len(known)), np.concatenate(seen))]
        placed = _placed(first.centre[known], found, others, reach[known])
        position, number = first.centre[known], np.arange(len(known))
        labels = [f"contact {j + 1}" for j in range(len(number))]
    else:
        check.instance("sites", sites, DesignSites, "a metafem.calibration.DesignSites")
        first, side = found[reference], sites.viewed_from
        try:
            match = match_sites(
                *(first.centre[first.complete], sites.position),
                viewed_from=side, rotation=sites.rotation, frame=first.frame,
            )  # fmt: skip
        except InvalidInput as error:
            raise InvalidInput(f"{printable(names[reference], 60)}: {error}") from None
        placed = _placed(match.to_image(sites.position), found, others, np.zeros(len(sites.position)))
        position, number = sites.position, sites.number
        labels = [f"site {s}" for s in number]
    area, sheared_area = (
        _at_sites(*each, len(position)) for each in zip(placed, (found, others), strict=True)
    )
    table = ContactTable(
        names, tests, loads, forces, position, np.asarray(number, dtype=np.intp), match is not None,
        *area, *sheared_area,
    )  # fmt: skip
    remarks = [
        text
        for i, name in enumerate(names)
        for where, each, views in (("", found, placed[0]), ("in the sheared image ", others, placed[1]))
        for text in _remarks(name, where, each[i], views[i], labels)
    ]
    notes = (
        []
        if match is None
        else [replace(each, text=f"{names[reference]}: {each.text}") for each in match.notes]
    )
    remedy = "give --sites" if match is None else "compare the numbers in its picture"
    notes += [
        Note(f"{name}: contacts may be shifted by one lattice distance; {remedy}")
        for name, one in zip(names, placed[0], strict=True)
        if one is not None and one.unclear
    ]
    return TrackedContacts(table, reference, match, *placed, tuple(remarks), tuple(notes))


@dataclass(frozen=True, eq=False, repr=False)
class DesignSites(Value):
    """The m sites of a design, with the viewing side and the rotation of the images.

    Parameters
    ----------
    position : array_like, (m, 2)
        Positions of the sites [mm], as in `heights.csv`.
    number : array_like of int, (m,), optional
        Numbers of the sites for tables; default: 0 to m - 1.
    viewed_from : {"glass", "block"}
        As for `match_sites`; default: "glass".
    rotation : float
        As for `match_sites` [rad]; default: 0.

    Raises
    ------
    InvalidInput
        If two sites have the same number, or if there is not one number for each site.

    Examples
    --------
    >>> DesignSites([[0.0, 0.0], [1.5, 0.0]]).number
    array([0, 1])
    """

    position: FloatArray
    number: NDArray[np.intp] = None  # type: ignore[assignment]
    viewed_from: str = "glass"
    rotation: float = 0.0

    def __post_init__(self) -> None:
        position = check.array("site_position", self.position, shape=(None, 2))
        m = len(position)
        number = np.arange(m) if self.number is None else np.asarray(self.number, dtype=np.intp)
        wrong = number.shape != (m,) or len(np.unique(number)) != m
        refuse_if(wrong, f"site must hold {m} different numbers, one for each site")
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "number", number)


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
        Pairs of a site that could not be measured and the region at it.
    unclear : bool
        Whether another shift, which differs by a distance between sites, matches about as many regions.
    """

    position: FloatArray
    site: IntArray
    outside: NDArray[np.bool_]
    spoilt: tuple[tuple[int, int], ...]
    unclear: bool = False

    def values(self, of_contact: FloatArray, of_open: float) -> FloatArray:
        """Return a quantity of the contacts at the sites, (m,); nan where it was not measured."""
        result = np.where(self.outside, np.nan, of_open)
        result[[site for site, _ in self.spoilt]] = np.nan
        matched = self.site >= 0
        result[self.site[matched]] = of_contact[matched]
        return result


# The sites in each image; None if there is no image or if the image could not be measured.
Views = tuple[Placed | None, ...]
Stack = Sequence[ContactAreas | None]


def _placed(position: FloatArray, areas: Stack, sheared: Stack, reach: FloatArray) -> tuple[Views, Views]:
    """Return the sites in each image and in each sheared image, from positions in another image [mm].

    `reach` (m,) is the error of uncertain positions [mm], 0 for others.
    """
    first = [None if one is None or one.failed else _View(one, position, reach).placed() for one in areas]
    second = [
        None
        if one is None or one.failed
        else _View(one, position if before is None else before.position, reach).placed()
        for one, before in zip(sheared, first, strict=True)
    ]
    return tuple(first), tuple(second)


@dataclass(frozen=True)
class _View:
    """Regions of an image, and the positions of the sites in another image with their errors."""

    areas: ContactAreas
    position: FloatArray
    own: FloatArray

    @cached_property
    def search(self) -> _Search:
        """Search for the sites of the complete regions."""
        return _Search(complex_points(self.areas.centre[self.areas.complete]), complex_points(self.position))

    def placed(self) -> Placed:
        """Return the sites in the image, with their contacts."""
        areas = self.areas
        shift, unclear = self.shift()
        site, spoilt = self.regions(shift)
        where = self.position + real_points([shift])
        outside = np.any((where < 0.0) | (where > areas.frame), axis=1)
        outside[site[site >= 0]] = False
        return Placed(where, site, outside, tuple(sorted(spoilt)), unclear)

    def shift(self) -> tuple[complex, bool]:
        """Return the shift of the sites, and whether another one is possible.

        The shortest shift is taken, unless a longer one matches clearly more regions.
        """
        points, spacing = self.search.points, self.search.spacing if len(self.position) > 1 else math.inf
        if not points.size:
            return 0j, False
        some = points[np.unique(np.linspace(0, len(points) - 1, GUESSES).astype(int))]
        shift = np.append((some[:, None] - self.search.sites).ravel(), 0.0)
        shift = shift[np.argsort(np.abs(shift), kind="stable")]
        short = shift[np.abs(shift) <= HALF * spacing]
        tried = [
            complex(shifts[i])
            for shifts, most in ((shift, REFINED), (short, GUESSES))
            for i in self.search.best(np.ones(len(shifts), complex), shifts, most)
        ]
        found = {each: self.votes(each) for each in map(self.settled, dict.fromkeys(tried))}
        order = sorted(found, key=lambda each: (-found[each], abs(each)))
        near = next((each for each in order if abs(each) <= HALF * spacing), order[0])
        most, clearly = found[order[0]], max(MORE, PART * self.areas.count)
        chosen = order[0] if most - found[near] >= clearly else near
        if chosen == near and found[near] == most and abs(near) <= CERTAIN * spacing:
            return near, False
        others = [count for each, count in found.items() if abs(each - chosen) > HALF * spacing]
        return chosen, max(others, default=0) > found[chosen] - clearly

    def votes(self, shift: complex) -> int:
        """Return the number of regions at sites, including merged regions and regions at the edge."""
        site, spoilt = self.regions(shift)
        return int((site >= 0).sum()) + len({region for _, region in spoilt})

    def settled(self, shift: complex) -> complex:
        """Return the median shift of the complete regions near sites."""
        search, reach = self.search, self.reach
        for _ in range(3):
            site, _ = search.assigned(1.0, shift, reach)
            if not (site >= 0).any():
                break
            away = search.points[site >= 0] - search.sites[site[site >= 0]]
            shift = complex(np.median(away.real), np.median(away.imag))
        return shift

    @cached_property
    def reach(self) -> float:
        """Largest distance of a contact from its site [mm]."""
        return self.search.reach() if len(self.position) > 1 else float(self.areas.axes.max())

    def regions(self, shift: complex) -> tuple[IntArray, list[tuple[int, int]]]:
        """Return the site of each region (n,), and the sites that other regions cover, with the region."""
        areas, search = self.areas, self.search
        site = np.full(areas.count, -1, dtype=np.intp)
        near, distance = search.assigned(1.0, shift, self.reach)
        if (near >= 0).any():
            near, _ = search.assigned(1.0, shift, search.reach(distance[np.isfinite(distance)]))
        site[areas.complete] = near
        taken, spoilt = set(site[site >= 0].tolist()), []
        where = self.position + real_points([shift])
        for region in sorted(np.flatnonzero(site < 0).tolist(), key=lambda i: not areas.complete[i]):
            inside = [s for s in self.within(region, where) if s not in taken]
            if areas.complete[region] and len(inside) == 1 and self.own[inside[0]] > 0.0:
                site[region] = inside[0]
            else:
                spoilt += [(s, region) for s in inside]
            taken.update(inside)
        return site, spoilt

    def within(self, region: int, where: FloatArray) -> list[int]:
        """Return the sites within a region's ellipse or near its centre, the nearest site first."""
        areas = self.areas
        away = complex_points(where - areas.centre[region]) * np.exp(-1j * areas.angle[region])
        distance = np.hypot(away.real / areas.axes[region, 0], away.imag / areas.axes[region, 1])
        close = (distance <= (SEMI_AXES if areas.edge[region] else 1.0)) | (np.abs(away) < self.own)
        order = np.argsort(distance, kind="stable")
        return [int(site) for site in order[close[order]]]


def _fullest(areas: Sequence[ContactAreas], names: Sequence[str], load: FloatArray) -> int:
    """Return the image with the most measurable contacts; images without a load come last."""
    complete = [int(np.count_nonzero(one.complete)) for one in areas]
    total = [one.area[one.complete].sum() for one in areas]
    order = [i for i in range(len(areas)) if complete[i]]
    listed = printable(", ".join(names), 120) or "an empty list of images"
    refuse_if(not order, f"no contact can be measured in {listed}")
    return min(order, key=lambda i: (np.isnan(load[i]), -complete[i], -total[i]))


def _remarks(
    image: str, where: str, areas: ContactAreas | None, found: Placed | None, names: list[str]
) -> Iterator[str]:
    """Yield sentences on what could not be measured in an image."""
    if areas is None:
        return
    spoilt = () if found is None else found.spoilt
    of_contacts = () if found is None else tuple(contact_notes(areas))
    yield from (f"{image}: {where}{note}" for note in areas.notes if note.warns and note not in of_contacts)
    for site, region in spoilt:
        others = [names[s] for s, own in spoilt if own == region and s != site]
        reason = "its region is not centred on the site, as if merged with another"
        if others:
            reason = f"merged with {' and '.join(others)}"
        elif areas.edge[region]:
            reason = "at the edge of the frame"
        elif areas.merged[region]:
            reason = "its outline is no ellipse, as that of two contacts in one"
        yield f"{image}, {names[site]}: {where}{reason}"


def _at_sites(found: Views, stack: Stack, count: int) -> tuple[FloatArray, FloatArray]:
    """Return areas at sites and their errors, (k, m); the error of an open site is the smallest area."""
    none = np.full(count, np.nan)
    rows = [
        (none, none)
        if one is None or areas is None
        else (one.values(areas.area, 0.0), one.values(areas.area_error, areas.smallest_area))
        for one, areas in zip(found, stack, strict=True)
    ]
    return np.array([area for area, _ in rows]), np.array([error for _, error in rows])


@dataclass(frozen=True, eq=False, repr=False)
class TrackedContacts(Value):
    """Contacts of a stack of images, their areas, and their positions in each image.

    Attributes
    ----------
    table : ContactTable
    reference : int
        Index of the reference image, whose contacts were matched to the sites or, without sites, numbered.
    match : SiteMatch or None
        Match of the reference image; None without sites.
    placed, placed_sheared : tuple, (k,)
        Sites in each image: their ``position`` (m, 2) [mm], and the ``site`` of each contact (n,), -1 if it
        has none; None if there is no image.
    remarks : tuple of str
        Sentences that state what could not be measured, with image and contact.
    notes : tuple of Note

    Examples
    --------
    >>> import numpy as np, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> image = 200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - 20.0))
    >>> areas = mf.calibration.contact_areas(image, 0.005)
    >>> tracked = mf.calibration.track_contacts([areas], ["1.tif"], load=[0.05])
    >>> tracked.table.area.shape, tracked.reference, tracked.match
    ((1, 1), 0, None)
    """

    table: ContactTable
    reference: int
    match: SiteMatch | None
    placed: Views
    placed_sheared: Views
    remarks: tuple[str, ...] = ()
    notes: tuple[Note, ...] = ()
