"""Contacts in images matched to the sites of a design, and followed through the images of one sample.

Points of the plane are complex numbers x + iy, so that a rotation and a scale are one factor.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.calibration.contact_table import contact_table, listed
from metafem.calibration.images import ContactAreas
from metafem.drawing import contacts as drawing
from metafem.errors import InvalidInput, refuse_if, shown
from metafem.notes import Note

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

Points = NDArray[np.complex128]
Pose = tuple[complex, complex, IntArray]

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
# in general, so that a contact is near one site only, and in a match, for errors of a few pixels. In a match
# it is MEDIANS times the median distance, about 7 standard deviations of normal errors.
REACH, LEAST_REACH, MEDIANS = 0.2, 0.02, 6.0

# Number of compared pairs of contacts, number of contacts that rate a similarity, and number of refined
# similarities. If a fifth of the regions are not contacts, a third of the pairs are useless.
PAIRS, RATING, REFINED = 40, 40, 24

# Largest number of steps of a refinement; three or four usually suffice.
STEPS = 20


def complex_points(points: Any, mirrored: bool = False) -> Points:
    """Return points (n, 2) as complex numbers x + iy, or -x + iy if mirrored, (n,)."""
    x, y = np.asarray(points, dtype=np.float64).reshape(-1, 2).T
    return np.asarray((-x if mirrored else x) + 1j * y, dtype=np.complex128)


def real_points(points: Any) -> FloatArray:
    """Return complex numbers (n,) as points (n, 2)."""
    return np.column_stack([np.real(points), np.imag(points)])


def spacing(points: Points) -> float:
    """Return the median distance between nearest neighbours."""
    where = real_points(points)
    return float(np.median(cKDTree(where).query(where, k=2)[0][:, 1]))


def _nearest(points: Points, sites: Points, reach: float) -> tuple[IntArray, FloatArray]:
    """Return the site of each contact, -1 for none, and its distance; both are nearest to each other."""
    distance, site = cKDTree(real_points(sites)).query(real_points(points), distance_upper_bound=reach)
    _, contact = cKDTree(real_points(points)).query(real_points(sites))
    own = np.append(contact, -1)[site] == np.arange(len(points))
    return np.where(own, site, -1), distance


def _refined(points: Points, sites: Points, factor: complex, shift: complex, reach: float) -> Pose:
    """Return factor, shift and the site of each contact, by least squares of the contacts near sites."""
    site = np.full(len(points), -2)
    for _ in range(STEPS):
        before, (site, distance) = site, _nearest(points, factor * sites + shift, reach)
        median = float(np.median(distance[site >= 0])) if np.any(site >= 0) else 0.0
        site = np.where(distance <= max(MEDIANS * median, LEAST_REACH / REACH * reach), site, -1)
        on = site >= 0
        if on.sum() < 2 or np.array_equal(site, before):
            break
        matrix = np.column_stack([sites[site[on]], np.ones(on.sum())])
        factor, shift = np.linalg.lstsq(matrix, points[on], rcond=None)[0].tolist()
    return factor, shift, site


def _best(points: Points, sites: Points, factor: Points, shift: Points) -> list[Pose]:
    """Return the refined poses of the similarities with the most contacts near sites."""
    some = points[np.unique(np.linspace(0, len(points) - 1, RATING).astype(int))]
    where, reach = ((some - shift[:, None]) / factor[:, None]).ravel(), REACH * spacing(sites)
    distance, _ = cKDTree(real_points(sites)).query(real_points(where), distance_upper_bound=reach)
    near = np.maximum(1.0 - (distance / reach) ** 2, 0.0).reshape(-1, len(some)).sum(axis=1)
    best = np.argsort(-near, kind="stable")[:REFINED].tolist()
    return [_refined(points, sites, complex(factor[i]), complex(shift[i]), reach) for i in best]


def _pairs(points: Points, sites: Points, rotation: float, turn: float) -> tuple[Points, Points]:
    """Return factors and shifts of the similarities that map a pair of sites to two neighbouring contacts."""
    where = real_points(points)
    second = cKDTree(where).query(where, k=FEWEST)[1][:, 1:].ravel()
    first = np.repeat(np.arange(len(points)), FEWEST - 1)
    chosen = np.unique(np.linspace(0, len(first) - 1, PAIRS).astype(int))
    between, start = (points[second] - points[first])[chosen], points[first][chosen]
    longest = float(np.abs(between).max()) / (1.0 - SLACK * STRETCH)
    one, two = cKDTree(real_points(sites)).query_pairs(longest, output_type="ndarray").T
    site, other = np.append(one, two), np.append(two, one)
    factor = between[:, None] / (sites[other] - sites[site])
    angle = np.abs(np.angle(factor * np.exp(-1j * rotation)))
    pair, at = np.nonzero((angle <= SLACK * turn) & (np.abs(np.abs(factor) - 1.0) <= SLACK * STRETCH))
    return factor[pair, at], start[pair] - factor[pair, at] * sites[site[at]]


def _matched(pose: Pose) -> int:
    """Return the number of contacts that have a site."""
    return int(np.count_nonzero(pose[2] >= 0))


def matches(points: Points, sites: Points, rotations: Sequence[float], turn: float) -> list[Pose]:
    """Return the different poses with the most matched contacts, near one of the rotations."""
    poses: list[Pose] = []
    for rotation in rotations:
        found = _best(points, sites, *_pairs(points, sites, rotation, turn))
        if any(map(_matched, found)):
            factor, _, site = max(found, key=_matched)
            on = points[site >= 0]
            central = on[np.argmin(np.abs(on - on.mean()))]  # any other site may be at this contact
            poses += found + _best(points, sites, np.full(len(sites), factor), central - factor * sites)
    most = max(map(_matched, poses), default=0)
    refuse_if(
        most < max(FEWEST, ON_SITES * len(points)),
        f"{len(points)} contacts or caps are not on the sites of the design: at best {most} of them; "
        f"neighbours are {spacing(points):.3g} mm apart, and {spacing(sites):.3g} mm in the design. Check "
        "the design, the pixel size, the rotation and the viewing side",
    )
    different = {pose[2].tobytes(): pose for pose in reversed(poses) if _matched(pose) == most}
    return list(different.values())[::-1]


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

    Each similarity (shift, rotation, and scale from 0.9 to 1.1) that maps a pair of sites to a pair of
    neighbouring contacts is rated by the number of contacts near sites, and the best ones are refined by
    least squares. There may be open contacts, regions that are not contacts, and sites outside the frame.

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
    angle, mirrored = check.number("rotation", rotation), SIDES[viewed_from]
    for what, count in (("contacts", len(centres)), ("sites", len(places))):
        few = f"{count} {what} cannot be matched: shift, rotation and scale need at least {FEWEST}"
        refuse_if(count < FEWEST, few)
    points, sites = complex_points(centres), complex_points(places, mirrored)
    coincident = "site_position holds coincident sites; each site must have a position of its own"
    refuse_if(spacing(sites) == 0.0, coincident)
    poses = matches(points, sites, [angle], TURN)
    # of several places, the one at which the design is about the contacts
    factor, shift, site = min(poses, key=lambda one: abs(one[0] * sites.mean() + one[1] - points.mean()))
    on = site >= 0
    away = points[on] - factor * sites[site[on]] - shift
    return SiteMatch(
        site=site,
        shift=real_points([shift])[0],
        rotation=float(np.angle(factor)),
        scale=abs(factor),
        mirrored=mirrored,
        residual=float(np.sqrt(np.mean(np.abs(away) ** 2))),
        ambiguous=len(poses) > 1,
    )


def track_contacts(
    areas: Mapping[str, ContactAreas | None],
    forces: DataFrame,
    *,
    site_position: ArrayLike | None = None,
    site_number: ArrayLike | None = None,
    viewed_from: str = "glass",
    rotation: float = 0.0,
) -> tuple[DataFrame, str, SiteMatch | None, list[Note]]:
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
    table, name, match, notes : DataFrame, str, SiteMatch or None, list of Note
        One row for each image and contact, as `contact_table` returns it; name of the reference image, and
        its match, None without sites.

    Raises
    ------
    InvalidInput
        If no image shows a contact, or if the reference, which the error names, does not match the sites.

    Examples
    --------
    >>> import numpy as np, pandas as pd, metafem as mf
    >>> y, x = np.mgrid[:60, :80]
    >>> image = 200.0 - 120.0 / (1.0 + np.exp(np.hypot(x - 40.0, y - 30.0) - 20.0))
    >>> areas = {"1.tif": mf.calibration.contact_areas(image, 0.005)}
    >>> forces = pd.DataFrame({"image": ["1.tif"], "sheared_image": "", "test": "", "load": 0.05})
    >>> table = track_contacts(areas, forces.assign(friction_force=np.nan))[0]
    >>> table[["image", "load", "contact", "area"]].round(3).values.tolist()
    [['1.tif', 0.05, 1, 0.032]]
    """
    names = forces["image"].tolist()
    unknown = dict(zip(names, forces["load"].isna(), strict=True))
    complete = {name: int(one.complete.sum()) for name in names if (one := areas[name]) is not None}
    usable = [name for name, count in complete.items() if count]
    refuse_if(not usable, f"no contact can be measured in {listed(names) or 'an empty list of images'}")
    reference = min(usable, key=lambda name: (unknown[name], -complete[name]))
    first: Any = areas[reference]
    if site_position is None:
        position = first.centre[first.complete | first.edge]
        match, number, where = None, None, position
    else:
        position = check.array("site_position", site_position, shape=(None, 2))
        number = np.arange(len(position)) if site_number is None else np.asarray(site_number)
        try:
            centre = first.centre[first.complete]
            match = match_sites(centre, position, viewed_from=viewed_from, rotation=rotation)
        except InvalidInput as error:
            raise InvalidInput(f"{reference}: {error}") from None
        where = match.to_image(position)
    text = f"{reference}: the contacts match the sites equally well in several places; an image in which"
    notes = [Note(f"{text} more contacts close can decide")] * bool(match and match.ambiguous)
    values = np.full((len(names), 4, len(where)), np.nan)
    for row, pair in zip(values, zip(names, forces["sheared_image"], strict=True), strict=True):
        before = complex_points(where)
        for i, name in enumerate(pair):
            one = areas.get(name)
            if one is not None:
                before, row[2 * i : 2 * i + 2], strays = _followed(one, before)
                text = f"{name}: {strays} regions are on no site; dust, or the sample moved too far"
                notes += [Note(text)] * (strays > 0)
    if match is None:  # a contact at the edge has a number if another image shows all of it
        seen = np.any(values[:, [0, 2]] > 0.0, axis=(0, 1))
        position, values = position[seen], values[:, :, seen]
    table = contact_table(forces, position, number, *values.swapaxes(0, 1))
    return table, reference, match, notes


def _followed(areas: ContactAreas, sites: Points) -> tuple[Points, FloatArray, int]:
    """Return the places of sites in an image, from those in another image, the areas at the sites and their
    errors (2, m), and the number of complete contacts that are on no site.

    The error of an open site is the smallest area that can be measured.
    """
    points, apart = complex_points(areas.centre[areas.complete]), spacing(sites) if len(sites) > 1 else np.inf
    site, _ = _nearest(points, sites, 0.5 * apart)
    for _ in range(STEPS):
        if np.any(site >= 0):
            away = (points - sites[site])[site >= 0]
            sites = sites + np.median(away.real) + 1j * np.median(away.imag)
        before, (site, _) = site, _nearest(points, sites, REACH * apart)
        if np.array_equal(site, before):
            break
    on, own = site[site >= 0], np.flatnonzero(areas.complete)[site >= 0]
    where, frame = real_points(sites), areas.pixel_size * np.array(areas.shape[::-1])
    unmeasured = np.any((where < 0.0) | (where > frame), axis=1)
    for region in np.setdiff1d(np.arange(areas.count), own):
        beside = (sites - complex_points(areas.centre[region])) * np.exp(-1j * areas.angle[region])
        unmeasured |= np.hypot(*(real_points(beside) / areas.axes[region]).T) <= 1.0
    values = np.where(unmeasured, np.nan, [[0.0], [areas.smallest_area]])
    values[:, on] = areas.area[own], areas.area_error[own]
    return sites, values, int((site < 0).sum())


def found_figure(
    image: NDArray[Any], areas: ContactAreas, rows: DataFrame, match: SiteMatch | None
) -> Figure:
    """Return a figure of an image with its contacts, the numbers of their sites, and the open sites.

    `rows` are those of the image in the table of contacts, and `match` is that of the image.
    """
    where = rows[["x", "y"]].to_numpy() if match is None else match.to_image(rows[["x", "y"]])
    figure = drawing.picture_figure(*image.shape[::-1])
    ax = figure.add_subplot()
    drawing.picture(ax, image, areas.pixel_size)
    area = rows["area"].to_numpy()
    kinds = np.select(
        [np.isin(areas.area, area), areas.complete], ["measured", "of no site"], "cut or merged"
    )
    for kind, colour in drawing.COLOURS.items():
        which = kinds == kind
        drawing.outlines(ax, areas.centre[which], areas.axes[which], areas.angle[which], colour, kind)
    drawing.crosses(ax, where[area == 0.0], "open")
    # put the number next to the contact, outside its outline
    away = where + 0.75 * np.sqrt(np.nan_to_num(area) / np.pi)[:, None] * [1.0, -1.0]
    numbers = (rows["contact"] if match is None else rows["site"] + 1).astype(str).to_numpy()
    drawing.numbers(ax, away, numbers, drawing.COLOURS["measured"])
    column = "contact" if match is None else "site"
    drawing.heading(ax, f"{rows['image'].iloc[0]}: numbers are those of the column {column}")
    return figure
