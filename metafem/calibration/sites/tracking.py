"""Tracking of the contacts in a stack of images of one sample, and their areas."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from metafem import _validate as check
from metafem._given import printable
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.contact_table import ContactTable
from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.images.measuring import contact_notes
from metafem.calibration.sites.match import SiteMatch, match_sites
from metafem.calibration.sites.placement import Placed, mean_positions, placed
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note

# The sites in each image; None if there is no image or if the image could not be measured.
Views = tuple[Placed | None, ...]

# Largest number of images to try until one can be matched to the sites, starting with the most contacts.
TRIED = 3


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
        If no image shows a contact, or if the images with the most contacts do not match the sites. The error
        names the image.

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
    forces = [
        np.full(k, np.nan) if values is None else check.array_with_gaps(name, values, shape=(k,))
        for name, values in (("load", load), ("friction_force", friction_force))
    ]
    stack = _Stack(found, others, names, tests, *forces)
    if sites is None:
        return stack.numbered()
    check.instance("sites", sites, DesignSites, "a metafem.calibration.DesignSites")
    return stack.matched(sites)


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


@dataclass(frozen=True)
class _Stack:
    """Images of a sample with their measured contacts, forces and names."""

    areas: tuple[ContactAreas, ...]
    sheared: tuple[ContactAreas | None, ...]
    image: tuple[str, ...]
    test: tuple[str, ...]
    load: FloatArray
    friction_force: FloatArray

    def fullest(self) -> list[int]:
        """Return the indices of the images, sorted by the number of measurable contacts, the largest first.

        Images without a load come last, because they may not belong to the test.
        """
        complete = [np.count_nonzero(one.complete) for one in self.areas]
        total = [one.area[one.complete].sum() for one in self.areas]
        no_load = np.isnan(self.load)
        order = sorted(range(len(complete)), key=lambda i: (no_load[i], -complete[i], -total[i]))
        order = [i for i in order if complete[i]]
        if not order:
            names = printable(", ".join(self.image), 120)
            raise InvalidInput(f"no contact can be measured in {names or 'an empty list of images'}")
        return order

    def numbered(self) -> TrackedContacts:
        """Return the tracked contacts with numbers from the top to the bottom of the fullest image."""
        reference = self.fullest()[0]
        areas = self.areas[reference]
        # a region at the edge counts if another image shows all of it; its semi-axis is the error of its
        # centre
        known = areas.complete | areas.edge
        reach = np.where(areas.edge, areas.axes[:, 0], 0.0)
        before: Sequence[Views] | None = None
        while True:
            centre = areas.centre[known]
            names = [f"contact {j + 1}" for j in range(len(centre))]
            before = found, _ = self._placed(centre, names, reach[known], before)
            sites = [one.site for one in found if one is not None]
            seen = np.isin(np.arange(len(centre)), np.concatenate(sites))
            if seen.all():
                break
            known[np.flatnonzero(known)[~seen]] = False
        number = np.arange(len(centre))
        centre = mean_positions(found, self.areas, centre)
        return self._tracked(reference, before, (centre, number, names), None)

    def matched(self, sites: DesignSites) -> TrackedContacts:
        """Return the tracked contacts with the sites of the design, matched in the fullest image."""
        reference, match = self._match(sites)
        names = [f"site {s}" for s in sites.number]
        found = self._placed(match.to_image(sites.position), names)
        return self._tracked(reference, found, (sites.position, sites.number, names), match)

    def _match(self, sites: DesignSites) -> tuple[int, SiteMatch]:
        """Return the index of the fullest image that can be matched, and its match."""
        errors = []
        for i in self.fullest()[:TRIED]:
            areas = self.areas[i]
            try:
                return i, match_sites(
                    areas.centre[areas.complete],
                    sites.position,
                    viewed_from=sites.viewed_from,
                    rotation=sites.rotation,
                    frame=areas.frame,
                )
            except InvalidInput as error:
                errors.append(f"{printable(self.image[i], 60)}: {error}")
        raise InvalidInput(errors[0])

    def _placed(
        self,
        position: FloatArray,
        names: list[str],
        reach: FloatArray | None = None,
        before: Sequence[Views] | None = None,
    ) -> tuple[Views, Views]:
        """Return the sites in each image and in each sheared image."""
        first, second = before or ((None,) * len(self.areas),) * 2
        found, sheared = [], []
        for i, (one, other) in enumerate(zip(self.areas, self.sheared, strict=True)):
            near = None if one.failed else placed(one, position, names, reach, first[i])
            where = position if near is None else near.position
            found.append(near)
            sheared.append(
                None if other is None or other.failed else placed(other, where, names, reach, second[i])
            )
        return tuple(found), tuple(sheared)

    def _tracked(
        self,
        reference: int,
        placed: tuple[Views, Views],
        sites: tuple[FloatArray, Any, list[str]],
        match: SiteMatch | None,
    ) -> TrackedContacts:
        """Return the tracked contacts at the sites."""
        position, number, names = sites
        remarks = [
            text
            for i, image in enumerate(self.image)
            for where, areas, views in (
                ("", self.areas[i], placed[0][i]),
                ("in the sheared image ", self.sheared[i], placed[1][i]),
            )
            for text in _remarks(image, where, areas, views, names)
        ]
        area, area_error = _at_sites(placed[0], self.areas, len(position))
        sheared_area, sheared_area_error = _at_sites(placed[1], self.sheared, len(position))
        table = ContactTable(
            image=self.image,
            test=self.test,
            load=self.load,
            friction_force=self.friction_force,
            position=position,
            site=np.asarray(number, dtype=np.intp),
            matched=match is not None,
            area=area,
            area_error=area_error,
            sheared_area=sheared_area,
            sheared_area_error=sheared_area_error,
        )
        of_match = () if match is None else match.notes
        notes = [replace(note, text=f"{self.image[reference]}: {note.text}") for note in of_match]
        remedy = "give --sites" if match is None else "compare the numbers in its picture"
        notes += [
            Note(f"{image}: contacts may be shifted by one lattice distance; {remedy}")
            for image, one in zip(self.image, placed[0], strict=True)
            if one is not None and one.unclear
        ]
        return TrackedContacts(table, reference, match, *placed, tuple(remarks), tuple(notes))


def _remarks(
    image: str, where: str, areas: ContactAreas | None, found: Placed | None, names: list[str]
) -> Iterator[str]:
    """Yield sentences on what could not be measured in an image."""
    if areas is not None:
        of_contacts = () if found is None else tuple(contact_notes(areas))
        yield from (
            f"{image}: {where}{note}" for note in areas.notes if note.warns and note not in of_contacts
        )
    for site, reason in () if found is None else found.spoilt:
        yield f"{image}, {names[site]}: {where}{reason}"


def _at_sites(
    found: Views, stack: Sequence[ContactAreas | None], count: int
) -> tuple[FloatArray, FloatArray]:
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
