"""Remarks on what could not be measured in an image."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.images.measuring import contact_notes
from metafem.calibration.sites.placement import Placed
from metafem.notes import Note


def remarks_of(
    image: str, where: str, areas: ContactAreas, found: Placed | None, names: list[str]
) -> tuple[list[str], list[tuple[int, str]]]:
    """Return the remarks on an image, and on its sites by their indices."""
    if found is None:
        texts = [str(note) for note in areas.notes] or ["could not be measured"]
        return [f"{image}: {where}{text}" for text in texts], []
    kind, of_contacts = names[0].split()[0], tuple(contact_notes(areas))
    general = [str(note) for note in areas.notes if note.warns and note not in of_contacts]
    if found.unclear:
        general.append(_unclear(kind))
    if len(found.strays):
        largest = found.strays[np.argmax(areas.area[found.strays])]
        x, y = areas.centre[largest]
        belong = "region belongs" if len(found.strays) == 1 else "regions belong"
        several = len(found.strays) > 1
        total = f", {areas.area[found.strays].sum():.3g} mm² in all" if several else ""
        general.append(
            f"{len(found.strays)} {belong} to no {kind}{total}; the largest has "
            f"{areas.area[largest]:.3g} mm² at ({x:.4g}, {y:.4g}) mm"
        )
    if found.outside.any():
        numbers = [names[s].split()[1] for s in np.flatnonzero(found.outside)]
        general.append(f"{kind}{'s' * (len(numbers) > 1)} {', '.join(numbers)} outside the frame")
    by_site = list(found.spoilt)
    for which, text in (
        (areas.saturated, "saturated grey levels, the area may be wrong"),
        (areas.holes > 0, "bright spots inside, which do not count as area"),
    ):
        by_site += [(int(s), text) for s in found.site[which & (found.site >= 0)]]
    return (
        [f"{image}: {where}{text}" for text in general],
        [(s, f"{image}, {names[s]}: {where}{text}") for s, text in by_site],
    )


def not_numbered(areas: ContactAreas, known: NDArray[np.bool_]) -> tuple[str, ...]:
    """Return a remark on unnumbered contacts in the image that numbers the known ones (n,)."""
    left = ~known & (areas.edge | areas.merged)
    if not left.any():
        return ()
    number, area = np.count_nonzero(left), areas.area[left].sum()
    what = "region" if number == 1 else "regions"
    return (f"{number} {what} at the edge of the frame or merged, with {area:.3g} mm², not numbered",)


def unclear_notes(image: Sequence[str], found: Sequence[Placed | None], kind: str) -> tuple[Note, ...]:
    """Return warnings on images in which the contacts or sites may be confused."""
    return tuple(
        Note(f"{name}: {_unclear(kind)}")
        for name, one in zip(image, found, strict=True)
        if one is not None and one.unclear
    )


def _unclear(kind: str) -> str:
    remedy = "give --sites" if kind == "contact" else "compare the numbers in its picture"
    return f"contacts may be shifted by one lattice distance; {remedy}"
