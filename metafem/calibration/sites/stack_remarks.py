"""Remarks on what could not be measured in an image."""

from __future__ import annotations

import numpy as np

from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.images.remarks import contact_notes
from metafem.calibration.sites.placement import Placed


def remarks_of(
    image: str, where: str, areas: ContactAreas, found: Placed | None, names: list[str]
) -> tuple[list[str], list[tuple[int, str]]]:
    """Return what is to be said of an image, and of its sites by their indices."""
    if found is None:
        texts = [str(note) for note in areas.notes] or ["could not be measured"]
        return [f"{image}: {where}{text}" for text in texts], []
    kind, of_contacts = names[0].split()[0], contact_notes(areas)
    general = [str(note) for note in areas.notes if note.warns and note not in of_contacts]
    if len(found.strays):
        largest = found.strays[np.argmax(areas.area[found.strays])]
        x, y = areas.centre[largest]
        belong = "region belongs" if len(found.strays) == 1 else "regions belong"
        general.append(
            f"{len(found.strays)} {belong} to no {kind}; the largest has {areas.area[largest]:.3g} mm² at "
            f"({x:.4g}, {y:.4g}) mm"
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
