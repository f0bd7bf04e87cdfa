"""Contact areas from a series of images with the measured forces, and the points for fits and laws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._given import printable
from metafem._validate import FloatArray, IntArray
from metafem._values import Value
from metafem.errors import refuse_if
from metafem.notes import Note, information

# Largest number of images or contacts that a sentence names.
NAMED = 5


@dataclass(frozen=True, eq=False, repr=False)
class ContactTable(Value):
    """Areas of n contacts in k images, and the forces at which the images were taken.

    If an image does not show a contact, the contact counts as open: its area is 0, and the error of its area
    is the smallest detectable area in the image. If a contact could not be measured, because it is at the
    edge of the frame or merged with another contact, its area is nan.

    Attributes
    ----------
    image : tuple of str, (k,)
        Names of the images.
    test : tuple of str, (k,)
        Name of the test of each image.
    load, friction_force : ndarray, (k,)
        Normal load and friction force [N]; nan where they were not measured.
    position : ndarray, (n, 2)
        Positions of the contacts [mm]: lattice sites if the contacts were matched, else mean centres.
    site : ndarray of int, (n,)
        Site numbers in the design, or 0 to n - 1 if the contacts were not matched.
    matched : bool
        Whether the contacts were matched to the sites of a lattice.
    area, area_error : ndarray, (k, n)
        Contact areas and their standard deviations [mm^2].
    sheared_area, sheared_area_error : ndarray, (k, n)
        Contact areas and their standard deviations in the images at the peak of the friction force [mm^2];
        nan where there is no such image.

    Examples
    --------
    >>> one, none = np.array([[0.1, 0.0]]), np.full((1, 2), np.nan)
    >>> table = ContactTable(
    ...     ("1.tif",), ("",), np.array([0.05]), np.array([np.nan]), np.array([[0.0, 0.0], [1.5, 0.0]]),
    ...     np.arange(2), False, one, 0.01 * one, none, none,
    ... )
    >>> table.area.sum(axis=1)
    array([0.1])
    """

    image: tuple[str, ...]
    test: tuple[str, ...]
    load: FloatArray
    friction_force: FloatArray
    position: FloatArray
    site: NDArray[np.intp]
    matched: bool
    area: FloatArray
    area_error: FloatArray
    sheared_area: FloatArray
    sheared_area_error: FloatArray

    def name_of(self, contact: int) -> str:
        """Return the name of a contact in tables and remarks.

        Parameters
        ----------
        contact : int
            Column of the contact, counted from 0.

        Examples
        --------
        >>> one, none = np.array([[0.1]]), np.full((1, 1), np.nan)
        >>> ContactTable(
        ...     ("1.tif",), ("",), np.array([0.05]), np.array([np.nan]), np.zeros((1, 2)), np.array([7]),
        ...     False, one, 0.01 * one, none, none,
        ... ).name_of(0)
        'contact 1'
        """
        return f"site {self.site[contact]}" if self.matched else f"contact {contact + 1}"


def listed(names: Sequence[str]) -> str:
    """Return a list of names as part of a sentence, shortened if it is long.

    Examples
    --------
    >>> listed(["1.tif", "2.tif", "3.tif", "4.tif", "5.tif", "6.tif", "7.tif"])
    '1.tif, 2.tif, 3.tif, 4.tif, 5.tif and 2 more'
    """
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(printable(name, 60) for name in names[:NAMED]) + more


def _images(table: ContactTable, which: NDArray[np.bool_]) -> str:
    """Return the names of the selected images (k,) as part of a sentence."""
    return listed([table.image[i] for i in np.flatnonzero(which).tolist()])


def _contacts(table: ContactTable, which: Any) -> str:
    """Return the names of the selected contacts (n,) as part of a sentence."""
    return listed([table.name_of(j) for j in np.flatnonzero(which).tolist()])


def pressed_images(table: ContactTable) -> tuple[NDArray[np.intp], tuple[Note, ...]]:
    """Return the numbers of the images that a compression fit uses, and notes on omitted images.

    The measured load is the sum over all contacts. If the area of one contact is unknown, so is its share of
    the load, and the image does not determine E*. A fit to the sum of the other areas would bias E*.
    """
    whole = np.isfinite(table.load) & np.isfinite(table.area).all(axis=1)
    used = np.flatnonzero(whole & (table.area > 0.0).any(axis=1))
    loaded = np.isfinite(table.load)
    left = loaded & ~np.isin(np.arange(len(loaded)), used)
    if not left.any():
        return used, ()
    missing = _contacts(table, ~np.isfinite(table.area[left]).all(axis=0)) or "all contacts"
    words = (
        f"E* is fitted without {_images(table, left)}: the area of {missing} is 0 or could not be measured"
    )
    return used, (Note(f"{words}, and the load is that of all contacts"),)


def sheared_points(table: ContactTable) -> tuple[FloatArray, NDArray[np.intp], tuple[Note, ...]]:
    """Return points for a shear fit (3, k), the image of each point (k,), and notes on missing quantities.

    The rows of the points are the areas before and after shear [mm^2] and the friction forces [N]. Values
    that were not measured are nan.

    An image gives one point if all its contacts were measured before and after shear. Otherwise it gives up
    to two points. One has the areas of the contacts that are visible before and after shear, and determines
    B. The other, if the sheared areas of all contacts are known, has their sum and the friction force, and
    determines sigma. The two points share the errors of the sheared areas; this only affects the covariance
    of B and sigma.

    A contact that is too small to be detected in one of the two images would bias the ratio of the sums, so B
    is fitted without it. If such a contact is not detected after shear, the sum for sigma contains an
    estimate of its sheared area: its area before shear times the ratio of the other contacts, but at most the
    smallest detectable area.
    """
    before, after, force = table.area, table.sheared_area, table.friction_force
    both = np.isfinite(before) & np.isfinite(after)
    seen = both & (before > 0.0) & (after > 0.0)
    one = both & ((before > 0.0) != (after > 0.0))
    first, second = (np.where(seen, area, 0.0).sum(axis=1) for area in (before, after))
    ratio = np.divide(second, first, np.zeros(first.shape), where=first > 0.0)[:, None]
    fell = one & (before > 0.0)
    filled = np.where(fell, np.minimum(ratio * np.where(fell, before, 0.0), table.sheared_area_error), after)
    total = filled.sum(axis=1)  # nan where a contact was not measured
    total = np.where(total > 0.0, total, np.nan)
    of_ratio = first > 0.0
    of_strength = np.isfinite(total) & np.isfinite(force)
    single = of_ratio & of_strength & both.all(axis=1) & ~one.any(axis=1)
    rows = []
    for i in np.flatnonzero(of_ratio | of_strength).tolist():
        if single[i]:
            rows.append((first[i], second[i], force[i], i))
            continue
        if of_ratio[i]:
            rows.append((first[i], second[i], np.nan, i))
        if of_strength[i]:
            rows.append((np.nan, total[i], force[i], i))
    columns = np.array(rows, dtype=np.float64).reshape(-1, 4).T
    unused = np.isfinite(force) & np.isfinite(after).any(axis=1) & ~of_strength
    said = (
        (
            one.any(axis=1) & of_ratio,
            "B is fitted without contacts that one image of a pair does not show: {}",
        ),
        (unused, "sigma is fitted without {}, which lack the sheared area of a contact"),
    )
    notes = tuple(information(words.format(_images(table, which))) for which, words in said if which.any())
    return columns[:3], columns[3].astype(np.intp), notes


def of_contacts(
    table: ContactTable, rescaled: bool, numbers: IntArray | None
) -> tuple[dict[str, Any], tuple[Note, ...]]:
    """Return the arrays of a measured law by name, and notes on the omitted images.

    `numbers` are the sites of the design's asperities; if None, asperity i is at site i. If friction forces
    were measured and can be `rescaled`, an image needs a friction force; otherwise it needs areas.
    """
    forces, total = np.isfinite(table.friction_force), ~np.isnan(table.area.sum(axis=1))
    by_force = rescaled and bool(forces.any())
    sites = table.matched & (table.site >= 0)
    # without friction forces, an image needs the areas of all contacts that have no site
    known = ~np.isnan(table.area)
    usable = known[:, ~sites].all(axis=1) & known.any(axis=1)
    used: NDArray[np.bool_] = np.isfinite(table.load) & (forces if by_force else usable)
    what = "a friction force" if by_force else "the areas of all its contacts"
    refuse_if(not used.any(), f"none of the {len(used)} images has a load and {what}")
    notes = [
        Note(f"image {table.image[i]} is left out: it has no {_missing(table, i, by_force)}")
        for i in np.flatnonzero(~used).tolist()
    ]
    overlooked = np.nanmax(np.where(table.area[used] == 0.0, table.area_error[used], 0.0))
    if overlooked > 0.0 and not by_force:
        words = (
            f"contacts of less than {overlooked:.2g} mm^2 count as open; the errors of the total areas do not"
        )
        notes.append(Note(f"{words} include what these contacts lack"))
    area, area_sd = table.area[used], np.nan_to_num(table.area_error[used])
    found: dict[str, Any] = {"load": table.load[used]}
    if forces[used].all():
        found["friction_force"] = table.friction_force[used]
    if table.matched:
        found |= {"asperity_area": area[:, sites], "asperity_area_sd": area_sd[:, sites]}
        found["site"] = _asperities(table.site[sites], numbers)
    sd = np.sqrt((np.where(area > 0.0, area_sd, 0.0) ** 2).sum(axis=1))  # without the errors of open contacts
    if total[used].all() or (table.matched and total[used].any()):
        found["area"] = area.sum(axis=1)
        if (sd > 0.0).all():  # an image without contacts has sd 0: use the default errors then
            found["area_sd"] = sd
    return found, tuple(notes)


def _asperities(sites: NDArray[np.intp], numbers: IntArray | None) -> NDArray[np.intp]:
    """Return the numbers of the design's asperities at sites."""
    if numbers is None:
        return sites
    place = {number: i for i, number in enumerate(numbers.tolist())}
    wrong = listed([str(site) for site in sites.tolist() if site not in place])
    refuse_if(wrong, f"the contacts have site {wrong}, which the design leaves empty or does not have")
    return np.array([place[site] for site in sites.tolist()], dtype=np.intp)


def _missing(table: ContactTable, i: int, by_force: bool) -> str:
    """Return the name of the quantity that image i lacks."""
    if np.isnan(table.load[i]):
        return "load"
    if by_force:
        return "friction force"
    return f"area of {table.name_of(int(np.isnan(table.area[i]).argmax()))}"
