"""The contacts of a stack of images of one sample, and their areas."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
from metafem.calibration.sites.match import SiteMatch, match_sites
from metafem.calibration.sites.placement import Placed, mean_positions, placed
from metafem.calibration.sites.stack_remarks import not_numbered, remarks_of, unclear_notes
from metafem.errors import InvalidInput
from metafem.notes import Note

# Largest number of images, those with the most contacts, that are matched to the sites until one succeeds.
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
    """Find the same contacts in all images of one sample, and list their areas.

    `match_sites` matches the image with the most contacts to the sites of the design; if loads are given, it
    is an image with a load. In the other images, the same sites are found after the shift that matches the
    most contacts. Without sites, the contacts of that image serve as sites, including those at its edge that
    are complete in another image. The shortest shift is used unless a longer one matches clearly more
    contacts; a warning names images where this is not clear. A site without a contact is open: its area is 0.
    A site outside the frame, at its edge or with a merged contact has the area nan and a remark.

    Parameters
    ----------
    areas : sequence of ContactAreas, (k,)
        Contacts of the images, as `stack_areas` returns them. One that ``failed`` has areas nan.
    image : sequence of str, (k,)
        Names of the images, all different.
    test : sequence of str, (k,), optional
        Name of the test of each image; default: none.
    load, friction_force : array_like, (k,), optional
        Normal load and friction force of each image [N]; nan where they are not known; default: not known.
    sheared : sequence of ContactAreas or None, (k,), optional
        Contacts of the images at the peak of the friction force; default: none.
    sites : DesignSites, optional
        Sites of the design and their view; default: contacts are numbered.

    Returns
    -------
    TrackedContacts

    Raises
    ------
    InvalidInput
        If no image shows a contact, or the images with the most contacts do not match the sites; the error
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
    stack = _Stack.checked(areas, image, test, load, friction_force, sheared)
    if sites is None:
        return stack.numbered()
    check.instance("sites", sites, DesignSites, "a metafem.calibration.DesignSites")
    shape = (len(stack.areas), len(sites.position))
    if sites.expected_area is not None and sites.expected_area.shape != shape:
        raise InvalidInput(f"expected_area has shape {sites.expected_area.shape}; it must have shape {shape}")
    return stack.matched(sites)


@dataclass(frozen=True, eq=False, repr=False)
class DesignSites(Value):
    """The m sites of a design and their view in images.

    Parameters
    ----------
    position : array_like, (m, 2)
        Sites of the design [mm], as in `heights.csv`.
    number : array_like of int, (m,), optional
        Numbers of the sites in the table; default: 0 to m - 1.
    expected_area : array_like, (k, m), optional
        Areas that the design's law predicts at the loads of k images [mm^2], nan where they are not known;
        default: none.
    viewed_from : {"glass", "block"}
        As for `match_sites`; default: "glass".
    rotation : float
        As for `match_sites` [rad]; default: 0.

    Raises
    ------
    InvalidInput
        If the numbers are not different, or not one for each site.

    Examples
    --------
    >>> DesignSites([[0.0, 0.0], [1.5, 0.0]]).number
    array([0, 1])
    """

    position: FloatArray
    number: NDArray[np.intp] = None  # type: ignore[assignment]
    expected_area: FloatArray | None = None
    viewed_from: str = "glass"
    rotation: float = 0.0

    def __post_init__(self) -> None:
        position = check.array("site_position", self.position, shape=(None, 2))
        m = len(position)
        number = np.arange(m) if self.number is None else np.asarray(self.number, dtype=np.intp)
        if number.shape != (m,) or len(np.unique(number)) != m:
            raise InvalidInput(f"site must hold {m} different numbers, one for each site")
        expected = None if self.expected_area is None else np.asarray(self.expected_area, dtype=np.float64)
        for name, value in (("position", position), ("number", number), ("expected_area", expected)):
            object.__setattr__(self, name, value)


@dataclass(frozen=True)
class _Stack:
    """The images of a sample with their measured contacts, forces and names."""

    areas: tuple[ContactAreas, ...]
    sheared: tuple[ContactAreas | None, ...]
    image: tuple[str, ...]
    test: tuple[str, ...]
    load: FloatArray
    friction_force: FloatArray

    @classmethod
    def checked(
        cls, areas: Any, image: Any, test: Any, load: Any, friction_force: Any, sheared: Any
    ) -> _Stack:
        """Return the stack, or raise InvalidInput."""
        found, names = tuple(areas), tuple(map(str, image))
        k = len(found)
        for one in found:
            check.instance("areas", one, ContactAreas, "ContactAreas, as stack_areas returns them")
        tests = ("",) * k if test is None else tuple(map(str, test))
        others = (None,) * k if sheared is None else tuple(sheared)
        for name, values in (("image", names), ("test", tests), ("sheared", others)):
            if len(values) != k:
                raise InvalidInput(f"{name} holds {len(values)} entries; areas holds {k}")
        twice = next((name for i, name in enumerate(names) if name in names[:i]), None)
        if twice is not None:
            raise InvalidInput(f"image holds {printable(twice, 60)} twice; names of images must differ")
        forces = (
            np.full(k, np.nan) if values is None else check.array_with_gaps(name, values, shape=(k,))
            for name, values in (("load", load), ("friction_force", friction_force))
        )
        return cls(found, others, names, tests, *forces)

    def fullest(self) -> list[int]:
        """Return the images, sorted by the number of measurable contacts, the largest first.

        If some have a load, images without one come last: they may not show the test.
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
        """Number the contacts of the fullest image from top to bottom of the frame."""
        reference = self.fullest()[0]
        areas = self.areas[reference]
        # a region at the edge counts if another image shows it whole; its centre is known to its semi-axis
        known = areas.complete | areas.edge
        reach = np.where(areas.edge, areas.axes[:, 0], 0.0)
        found: Sequence[Placed | None] = [None] * len(self.areas)
        sheared = found
        while True:
            centre = areas.centre[known]
            names = [f"contact {j + 1}" for j in range(len(centre))]
            found, sheared = self._placed(centre, names, reach[known], found, sheared)
            sites = [one.site for one in found if one is not None]
            seen = np.isin(np.arange(len(centre)), np.concatenate(sites))
            if seen.all():
                break
            known[np.flatnonzero(known)[~seen]] = False
        remarks = self._remarks(found, sheared, names, {reference: not_numbered(areas, known)})
        centre = mean_positions(found, self.areas, centre)
        table = self._table(found, sheared, centre, np.arange(len(centre)), False, remarks)
        return TrackedContacts(
            table, reference, None, found, sheared, unclear_notes(self.image, found, "contact")
        )

    def matched(self, sites: DesignSites) -> TrackedContacts:
        """Match the contacts of the fullest image to sites."""
        reference, match = self._match(sites)
        names = [f"site {s}" for s in sites.number]
        found, sheared = self._placed(match.to_image(sites.position), names)
        own = {reference: tuple(str(note) for note in match.notes if note.warns)}
        remarks = self._remarks(found, sheared, names, own)
        table = self._table(found, sheared, sites.position, sites.number, True, remarks)
        notes = tuple(replace(note, text=f"{self.image[reference]}: {note.text}") for note in match.notes)
        return TrackedContacts(
            table, reference, match, found, sheared, (*notes, *unclear_notes(self.image, found, "site"))
        )

    def _match(self, sites: DesignSites) -> tuple[int, SiteMatch]:
        """Return the fullest image that can be matched, and its match."""
        first: InvalidInput | None = None
        for i in self.fullest()[:TRIED]:
            areas = self.areas[i]
            known = None if sites.expected_area is None else sites.expected_area[i]
            decided = known is not None and np.isfinite(known).all()
            try:
                match = match_sites(
                    areas.centre[areas.complete],
                    sites.position,
                    viewed_from=sites.viewed_from,
                    rotation=sites.rotation,
                    area=areas.area[areas.complete],
                    expected_area=known if decided else None,
                    frame=areas.frame,
                )
            except InvalidInput as error:
                first = first or InvalidInput(f"{printable(self.image[i], 60)}: {error}")
                continue
            return i, match
        raise first or AssertionError  # fullest() returns at least one image

    def _placed(
        self,
        position: FloatArray,
        names: list[str],
        reach: FloatArray | None = None,
        *before: Sequence[Placed | None],
    ) -> tuple[tuple[Placed | None, ...], tuple[Placed | None, ...]]:
        """Return the sites in each image, and in each sheared one."""
        first, second = before or ([None] * len(self.areas),) * 2
        found = tuple(
            None if one.failed else placed(one, position, names, reach, known)
            for one, known in zip(self.areas, first, strict=True)
        )
        sheared = tuple(
            None
            if one is None or one.failed
            else placed(one, position if near is None else near.position, names, reach, known)
            for one, near, known in zip(self.sheared, found, second, strict=True)
        )
        return found, sheared

    def _remarks(
        self,
        found: Sequence[Placed | None],
        sheared: Sequence[Placed | None],
        names: list[str],
        own: Mapping[int, tuple[str, ...]],
    ) -> tuple[str, ...]:
        """Return the remarks in order of the images, including the `own` ones of each image."""
        remarks: list[str] = []
        for i, image in enumerate(self.image):
            remarks += [f"{image}: {text}" for text in own.get(i, ())]
            ahead, behind = remarks_of(image, "", self.areas[i], found[i], names)
            if (other := self.sheared[i]) is not None:
                first, second = remarks_of(image, "in the sheared image ", other, sheared[i], names)
                ahead, behind = [*ahead, *first], [*behind, *second]
            remarks += [*ahead, *(text for _, text in sorted(behind))]
        return tuple(remarks)

    def _table(
        self,
        found: Sequence[Placed | None],
        sheared: Sequence[Placed | None],
        position: FloatArray,
        number: Any,
        matched: bool,
        remarks: tuple[str, ...],
    ) -> ContactTable:
        none = np.full(len(position), np.nan)

        def stacked(
            sites: Sequence[Placed | None], stack: Any, quantity: str, of_open: str = ""
        ) -> FloatArray:
            rows = [
                none
                if one is None or areas is None
                else one.values(getattr(areas, quantity), getattr(areas, of_open) if of_open else 0.0)
                for one, areas in zip(sites, stack, strict=True)
            ]
            return np.array(rows)

        area, sheared_area = stacked(found, self.areas, "area"), stacked(sheared, self.sheared, "area")
        area_error, sheared_area_error = (
            stacked(sites, stack, "area_error", "smallest_area")
            for sites, stack in ((found, self.areas), (sheared, self.sheared))
        )
        return ContactTable(
            image=self.image,
            test=self.test,
            load=self.load,
            friction_force=self.friction_force,
            position=position,
            site=np.asarray(number, dtype=np.intp),
            matched=matched,
            area=area,
            area_error=area_error,
            sheared_area=sheared_area,
            sheared_area_error=sheared_area_error,
            remarks=remarks,
        )


@dataclass(frozen=True, eq=False, repr=False)
class TrackedContacts(Value):
    """The contacts of a stack of images, and their positions in each.

    Attributes
    ----------
    table : ContactTable
    reference : int
        Index of the image with the most contacts; these were matched or, without sites, numbered.
    match : SiteMatch or None
        Match of that image; None without sites.
    placed, placed_sheared : tuple, (k,)
        For each image the sites in it: ``position`` (m, 2) [mm], and ``site`` (n,) of each of its contacts,
        -1 where there is none; None where there is no image.
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
    placed: tuple[Placed | None, ...]
    placed_sheared: tuple[Placed | None, ...]
    notes: tuple[Note, ...] = ()
