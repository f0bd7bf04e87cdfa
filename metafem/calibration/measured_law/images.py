"""The arrays of a measured law from the contacts in images."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._validate import IntArray
from metafem.calibration.contact_table import ContactTable
from metafem.errors import InvalidInput
from metafem.notes import Note


def of_contacts(
    table: ContactTable, rescaled: bool, numbers: IntArray | None
) -> tuple[dict[str, Any], tuple[Note, ...]]:
    """Return the arrays of a law by name, and notes that name the images that are left out.

    `numbers` are the sites of the design's asperities; without them, these have the numbers of the sites.
    Friction forces are used where they can be `rescaled`, else the areas.
    """
    forces, total = np.isfinite(table.friction_force), ~np.isnan(table.area.sum(axis=1))
    by_force = rescaled and bool(forces.any())
    sites = table.matched & (table.site >= 0)
    # without friction forces, the areas of some contacts are of use where those of all others are known
    known = ~np.isnan(table.area)
    usable = known[:, ~sites].all(axis=1) & known.any(axis=1)
    kept: NDArray[np.bool_] = np.isfinite(table.load) & (forces if by_force else usable)
    if not kept.any():
        what = "a friction force" if by_force else "the areas of all its contacts"
        raise InvalidInput(f"none of the {len(kept)} images has a load and {what}")
    notes = [
        Note(f"image {table.image[i]} is left out: it has no {_missing(table, i, by_force)}")
        for i in np.flatnonzero(~kept).tolist()
    ]
    notes += _unknown(table, kept, ~known & sites)
    overlooked = np.nanmax(np.where(table.area[kept] == 0.0, table.area_error[kept], 0.0))
    if overlooked > 0.0 and not by_force:
        notes.append(
            Note(
                f"contacts of less than {overlooked:.2g} mm^2 count as open; the errors of the total areas "
                "do not include what these contacts lack"
            )
        )
    area, area_sd = table.area[kept], np.nan_to_num(table.area_error[kept])
    found: dict[str, Any] = {"load": table.load[kept]}
    if forces[kept].all():
        found["friction_force"] = table.friction_force[kept]
    if table.matched:
        found |= {"asperity_area": area[:, sites], "asperity_area_sd": area_sd[:, sites]}
        found["site"] = _asperities(table.site[sites], numbers)
    sd = np.sqrt((np.where(area > 0.0, area_sd, 0.0) ** 2).sum(axis=1))  # open contacts are taken as open
    if total[kept].all() or (table.matched and total[kept].any()):
        found["area"] = area.sum(axis=1)
        if (sd > 0.0).all():  # else from the errors: an image without contacts has none
            found["area_sd"] = sd
    return found, tuple(notes)


def _asperities(sites: NDArray[np.intp], numbers: IntArray | None) -> NDArray[np.intp]:
    """Return the asperities of the design at sites."""
    if numbers is None:
        return sites
    order = np.argsort(numbers)
    place = np.minimum(np.searchsorted(numbers, sites, sorter=order), len(numbers) - 1)
    found = order[place]
    for site in sites[numbers[found] != sites][:1]:
        raise InvalidInput(f"the contacts have site {site}, which the design leaves empty or does not have")
    return found


def _unknown(table: ContactTable, kept: NDArray[np.bool_], unknown: NDArray[np.bool_]) -> list[Note]:
    """Return which areas of contacts (k, n) the images that are kept lack, one note for images alike."""
    images: dict[str, list[str]] = {}
    for i in np.flatnonzero(kept & unknown.any(axis=1)).tolist():
        sites = table.site[unknown[i]].tolist()
        several = "s" if len(sites) > 1 else ""
        where = f"area{several} of the contact{several} at site{several} {', '.join(map(str, sites))}"
        images.setdefault(where, []).append(table.image[i])
    return [
        Note(
            f"{_named(names)}: the {where} {'are' if where.startswith('areas') else 'is'} unknown; the other "
            "contacts are used"
        )
        for where, names in images.items()
    ]


def _named(images: list[str]) -> str:
    """Return the names of images, of many the first and the last."""
    if len(images) == 1:
        return f"image {images[0]}"
    return f"{len(images)} images, {images[0]} to {images[-1]}"


def _missing(table: ContactTable, i: int, by_force: bool) -> str:
    """Return what image i lacks."""
    if np.isnan(table.load[i]):
        return "load"
    if by_force:
        return "friction force"
    return f"area of {table.name_of(int(np.isnan(table.area[i]).argmax()))}"
