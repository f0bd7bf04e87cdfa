"""Remarks on the contacts that could not be measured in an image."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.images.measuring import contact_notes
from metafem.calibration.sites.placement import Placed


def remarks_of(
    image: str,
    areas: Sequence[ContactAreas | None],
    found: Sequence[Placed | None],
    names: list[str],
) -> list[str]:
    """Return remarks on an image and its sheared image: general remarks first, then remarks by site."""
    general: list[str] = []
    by_site: list[tuple[int, str]] = []
    for where, one, sites in zip(("", "in the sheared image "), areas, found, strict=True):
        if one is None:
            continue
        general += [f"{image}: {where}{text}" for text in _general(one, sites, names)]
        by_site += [(s, f"{image}, {names[s]}: {where}{text}") for s, text in _of_sites(one, sites)]
    return [*general, *(text for _, text in sorted(by_site))]


def _general(areas: ContactAreas, found: Placed | None, names: list[str]) -> list[str]:
    """Return the general remarks on an image."""
    if found is None:
        return [str(note) for note in areas.notes] or ["could not be measured"]
    kind, of_contacts = names[0].split()[0], tuple(contact_notes(areas))
    texts = [str(note) for note in areas.notes if note.warns and note not in of_contacts]
    if found.unclear:
        texts.append(unclear(names))
    count = len(found.strays)
    if count:
        largest = found.strays[np.argmax(areas.area[found.strays])]
        x, y = areas.centre[largest]
        belong = "region belongs" if count == 1 else "regions belong"
        total = f", {areas.area[found.strays].sum():.3g} mm² in all" if count > 1 else ""
        texts.append(
            f"{count} {belong} to no {kind}{total}; the largest has {areas.area[largest]:.3g} mm² at "
            f"({x:.4g}, {y:.4g}) mm"
        )
    if found.outside.any():
        numbers = [names[s].split()[1] for s in np.flatnonzero(found.outside)]
        texts.append(f"{kind}{'s' * (len(numbers) > 1)} {', '.join(numbers)} outside the frame")
    return texts


def _of_sites(areas: ContactAreas, found: Placed | None) -> list[tuple[int, str]]:
    """Return pairs of site index and remark for the sites in an image."""
    if found is None:
        return []
    flagged = (
        (areas.saturated, "saturated grey levels, the area may be wrong"),
        (areas.holes > 0, "bright spots inside, which do not count as area"),
    )
    flags = [(int(s), text) for which, text in flagged for s in found.site[which & (found.site >= 0)]]
    return [*found.spoilt, *flags]


def not_numbered(areas: ContactAreas, known: NDArray[np.bool_]) -> tuple[str, ...]:
    """Return a remark on contacts without a number; `known` (n,) marks the numbered contacts."""
    left = ~known & (areas.edge | areas.merged)
    if not left.any():
        return ()
    number, area = np.count_nonzero(left), areas.area[left].sum()
    what = "region" if number == 1 else "regions"
    return (f"{number} {what} at the edge of the frame or merged, with {area:.3g} mm², not numbered",)


def unclear(names: list[str]) -> str:
    """Return the remark on an image in which contacts may be assigned to wrong sites."""
    remedy = "give --sites" if names[0].startswith("contact") else "compare the numbers in its picture"
    return f"contacts may be shifted by one lattice distance; {remedy}"
