"""What is to be said about the contacts of an image."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from metafem._values import percent
from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.images.illumination import Ground
from metafem.calibration.images.levels import Levels
from metafem.notes import Note, information

# Structure of the ground, over the contrast, above which it is said: with it, the half level is wrong by 1 %.
UNEVEN = 0.02

# Contacts that a note names.
NAMED = 10


def remarks(found: ContactAreas, levels: Levels, ground: Ground, dropped: int, drift: float) -> ContactAreas:
    """Return the contacts with notes on what was left out and on what is uncertain.

    `drift` is the difference of the contacts' grey level from that of the levels, over the contrast.
    """
    notes = []
    if levels.cut:
        notes.append(
            Note(
                "all contacts are at the edge of the frame or merged: the blur is not measured; give blur, "
                "or measure the image in one series with one of whole contacts"
            )
        )
    elif levels.narrow:
        notes.append(
            Note(
                "no contact is wide enough to show its dark level: areas may be wrong by more "
                "than their errors; give dark_level, threshold and blur of an image with larger contacts, or "
                "measure both in one series"
            )
        )
    if levels.sparse:
        notes.append(
            information(
                "the contacts cover too little of the image for Otsu's method, whose threshold is within the "
                "noise of the ground; the level half-way to the darkest region is used instead"
            )
        )
    if dropped:
        notes.append(
            information(
                f"{dropped} dark spot{'s' * (dropped > 1)} below {found.smallest_area:.2g} mm^2 left out"
            )
        )
    if not ground.divided:
        notes.append(information("the ground is so dark that it was subtracted, and not divided by"))
    contrast = 1.0 - levels.dark
    if ground.structure > UNEVEN * contrast:
        uneven = percent(ground.structure / contrast)
        notes.append(Note(f"the ground is uneven by {uneven} of the contrast after removing the gradient"))
    if drift:
        notes.append(
            Note(
                f"the contacts are {'brighter' if drift > 0.0 else 'darker'} by {percent(abs(drift))} of the "
                "contrast than in the image at the largest load, and the errors of the areas are increased "
                "by what this may cause; keep lamp and exposure, or measure this image alone"
            )
        )
    return replace(found, notes=(*notes, *contact_notes(found)))


def contact_notes(found: ContactAreas) -> list[Note]:
    """Return the notes that name contacts: at the edge, merged, saturated or with bright spots inside."""
    notes = []
    for flags, text in (
        (found.edge, "at the edge of the frame; the area is what is seen of them"),
        (found.merged, "merged with others, or not convex; the area is that of all in one"),
        (found.saturated, "saturated: grey levels are cut off at an end of the scale; lower the exposure"),
    ):
        if flags.any():
            notes.append(Note(f"{_named(found, flags)}: {text}"))
    if (found.holes > 0).any():
        notes.append(information(f"{_named(found, found.holes > 0)}: bright spots inside are left out"))
    return notes


def _named(found: ContactAreas, flags: NDArray[np.bool_]) -> str:
    """Return contacts by number and centre."""
    which = np.flatnonzero(flags)
    parts = [
        f"{i} at ({found.centre[i, 0]:.4g}, {found.centre[i, 1]:.4g}) mm" for i in which[:NAMED].tolist()
    ]
    more = f" and {which.size - NAMED} more" if which.size > NAMED else ""
    return f"contact{'s' * (which.size > 1)} {', '.join(parts)}{more}"
