"""The size of the pixels of images, as the files and the user state it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from metafem._given import printable
from metafem._values import MICROMETRES, percent
from metafem.errors import refuse_if
from metafem.files.measurement.images.pages import ImageFile, Resolution
from metafem.notes import Note, information

# Resolutions that programs write by default [per inch], and the accuracy with which PNG stores them.
DEFAULTS, STORED = (72.0, 96.0, 100.0, 150.0, 200.0, 300.0, 600.0), 0.05
MILLIMETRES_PER_INCH = 25.4

# Relative differences of two sizes of pixels. Above SAME, the sizes of two files differ. Above NEAR, areas
# change by more than 1 %, and a warning is given.
SAME, NEAR = 1e-3, 5e-3

EXAMPLE = 'add the size of a pixel in the plane of the contacts, for example --pixel "5.3 um"'


def pixel_size(images: Sequence[ImageFile], given: float | None = None) -> tuple[float, list[Note]]:
    """Return the side of a pixel [mm] and notes on its source.

    The size is `given` [mm] or, by default, the size that all files state. Resolutions of 72 per inch and
    other default values of programs are ignored. Without `given`, raise InvalidInput if a file states no
    size, or if the sizes of two images or of the two directions differ.
    """
    whole = [image for image in images if not image.broken]
    reason = "there are none" if not images else f"{printable(images[0].name)}: {images[0].broken}"
    refuse_if(not whole, f"none of the images can be read: {reason}")
    known = [(image.name, image.resolution) for image in whole if image.resolution is not None]
    stated = {name: resolution for name, resolution in known if not _default(resolution)}
    if given is None:
        missing = [image.name for image in whole if image.name not in stated]
        state = "states" if len(missing) == 1 else "state"
        refuse_if(missing, f"{_first(missing)} {state} no size of the pixels; {EXAMPLE}")
        return _common(stated)
    differing = [name for name, one in stated.items() if max(_off(one.x, given), _off(one.y, given)) > NEAR]
    if not differing:
        return given, []
    one = stated[differing[0]]
    ratio = (given / one.x) * (given / one.y)
    sides = _um(one.x) if _off(one.x, one.y) <= SAME else f"{_um(one.x)} x {_um(one.y)}"
    return given, [
        Note(
            f"{_first(differing, ' (', ')')} states pixels of {sides} by {one.source}, and --pixel "
            f"{_um(given)} is used: areas change by {percent(ratio - 1.0, '+.3g')}"
        )
    ]


def _common(stated: Mapping[str, Resolution]) -> tuple[float, list[Note]]:
    """Return the size that all images state [mm], with a note; raise InvalidInput if the sizes differ."""
    first, one = next(iter(stated.items()))
    for name, other in stated.items():
        label = printable(name, 60)
        oblong = f"{label} states oblong pixels, {_um(other.x)} x {_um(other.y)}, by {other.source}"
        refuse_if(_off(other.x, other.y) > SAME, f"{oblong}; scale the image, or {EXAMPLE}")
        both = f"{printable(first, 60)} states pixels of {_um(one.x)}, and {label} of {_um(other.x)}"
        refuse_if(_off(other.x, one.x) > SAME, f"{both}; measure them one after the other, or {EXAMPLE}")
    return one.x, [information(f"pixels of {_um(one.x)}, as {printable(first, 60)} states by {one.source}")]


def _first(names: Sequence[str], before: str = " ", after: str = "") -> str:
    """Return the first name and the number of other images, as text."""
    more = "" if len(names) < 2 else f"{before}and {len(names) - 1} more images{after}"
    return printable(names[0], 60) + more if names else ""


def _default(resolution: Resolution) -> bool:
    """Return whether a resolution is one that programs write by default."""
    per_inch = MILLIMETRES_PER_INCH / resolution.x
    return "per inch" in resolution.source and any(abs(per_inch - value) < STORED for value in DEFAULTS)


def _off(size: float, other: float) -> float:
    """Return the relative difference of two sizes."""
    return abs(size / other - 1.0)


def _um(size: float) -> str:
    return f"{MICROMETRES * size:.4g} um"
