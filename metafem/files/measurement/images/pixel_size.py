"""The size of the pixels of images, from their files and from the user."""

from __future__ import annotations

from collections.abc import Sequence

from metafem._given import printable
from metafem._values import MICROMETRES, percent
from metafem.errors import InvalidInput
from metafem.files.measurement.images.find import ImageFile
from metafem.files.measurement.images.pages import Page, Resolution
from metafem.notes import Note, information

# Default resolutions of programs [per inch], and the accuracy with which PNG stores them.
DEFAULTS, STORED = (72.0, 96.0, 100.0, 150.0, 200.0, 300.0, 600.0), 0.05
MILLIMETRES_PER_INCH = 25.4

# Relative differences of two stated sizes: above the first they differ; at the second, areas differ by 1 %.
SAME, NEAR = 1e-3, 5e-3

EXAMPLE = 'add the size of a pixel in the plane of the contacts, for example --pixel "5.3 um"'


def pixel_size(images: Sequence[ImageFile], given: float | None = None) -> tuple[float, list[Note]]:
    """Return the side of a pixel [mm] and notes on its source.

    It is the given size, or the size that all files state. Resolutions of 72 per inch and other round default
    values of programs do not count. Raise InvalidInput if the size is neither given nor stated, or if two
    images or the two directions differ.
    """
    whole = [(image.name, image.page) for image in images if image.page is not None]
    if not whole:
        reason = f"{printable(images[0].name)}: {images[0].broken}" if images else "there are none"
        raise InvalidInput(f"none of the images can be read: {reason}")
    stated = [(name, page.resolution) for name, page in whole if page.resolution is not None]
    stated = [(name, resolution) for name, resolution in stated if not _default(resolution)]
    if given is None:
        return _of_files(whole, stated)
    notes = []
    differing = [(name, one) for name, one in stated if max(_off(one.x, given), _off(one.y, given)) > NEAR]
    if differing:
        name, one = differing[0]
        more = f" (and {len(differing) - 1} more images)" if len(differing) > 1 else ""
        ratio = (given / one.x) * (given / one.y)
        notes.append(
            Note(
                f"{printable(name, 60)}{more} states pixels of {_shown(one)} by {one.source}, and --pixel "
                f"{_um(given)} is used: areas change by {percent(ratio - 1.0, '+.3g')}"
            )
        )
    return given, notes


def _of_files(
    whole: Sequence[tuple[str, Page]], stated: Sequence[tuple[str, Resolution]]
) -> tuple[float, list[Note]]:
    """Return the size that all files state."""
    known = {name for name, _ in stated}
    missing = [name for name, _ in whole if name not in known]
    if missing:
        which = printable(missing[0], 60) + (
            f" and {len(missing) - 1} more images" if len(missing) > 1 else ""
        )
        raise InvalidInput(f"{which} state{'s' * (len(missing) == 1)} no size of the pixels; {EXAMPLE}")
    first, one = stated[0]
    for name, other in stated:
        if _off(other.x, other.y) > SAME:
            raise InvalidInput(
                f"{printable(name, 60)} states oblong pixels, {_um(other.x)} x {_um(other.y)}, by "
                f"{other.source}; scale the image, or {EXAMPLE}"
            )
        if _off(other.x, one.x) > SAME:
            raise InvalidInput(
                f"{printable(first, 60)} states pixels of {_um(one.x)}, and {printable(name, 60)} of "
                f"{_um(other.x)}; measure them one after the other, or {EXAMPLE}"
            )
    return one.x, [information(f"pixels of {_um(one.x)}, as {printable(first, 60)} states by {one.source}")]


def _default(resolution: Resolution) -> bool:
    """Whether a resolution is a default value of programs."""
    per_inch = MILLIMETRES_PER_INCH / resolution.x
    return "per inch" in resolution.source and any(abs(per_inch - value) < STORED for value in DEFAULTS)


def _off(size: float, other: float) -> float:
    """Return the relative difference of two sizes."""
    return abs(size / other - 1.0)


def _shown(resolution: Resolution) -> str:
    if _off(resolution.x, resolution.y) <= SAME:
        return _um(resolution.x)
    return f"{_um(resolution.x)} x {_um(resolution.y)}"


def _um(size: float) -> str:
    return f"{MICROMETRES * size:.4g} um"
