"""Images as grey values, clipped pixels, and the options of the measurement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem import _validate as check
from metafem._extras import refuse_missing
from metafem._given import shown
from metafem.errors import InvalidInput

# Smallest number of pixels along the shorter side of an image: a contact and the ground around it.
FEWEST = 16

# Largest grey levels of cameras, whose pictures of 10 to 14 bits are stored in 16.
FULL_SCALE = tuple(2**bits - 1 for bits in (8, 10, 12, 14, 16, 32))


def grey_values(image: Any) -> NDArray[Any]:
    """Return the grey values (rows, columns) of an image, row 0 uppermost, in its own type of numbers."""
    if isinstance(image, (str, bytes)) or hasattr(image, "__fspath__"):
        raise InvalidInput(
            f"image = {shown(image)} is a name; it must be an array of grey values. "
            "`metafem images` reads files"
        )
    try:
        values = np.asarray(np.ma.getdata(image) if not np.ma.is_masked(image) else None)
    except (TypeError, ValueError):
        raise InvalidInput(f"image = {shown(image)} must be an array of grey values") from None
    if values.dtype.kind not in "uif":
        raise InvalidInput(
            f"image must be an array of grey values without mask; its entries are {values.dtype}"
        )
    values = _one_channel(values)
    if values.ndim != 2 or min(values.shape) < FEWEST:
        several = "; a stack of images is measured by stack_areas" if values.ndim > 2 else ""
        raise InvalidInput(
            f"image has shape {values.shape}; it must be (rows, columns) with at least "
            f"{FEWEST} of each{several}"
        )
    finite = np.isfinite(values)
    if not finite.all():
        row, column = np.argwhere(~finite)[0].tolist()
        raise InvalidInput(
            f"image holds {values[row, column]} in row {row}, column {column}; all grey values must be finite"
        )
    low, high = float(values.min()), float(values.max())
    if low == high:
        raise InvalidInput(
            f"image is constant: all its grey values are {low:g}, all dark or all bright; it shows no contact"
        )
    if not max(abs(low), abs(high)) < float(np.finfo(np.float32).max) / values.size:
        raise InvalidInput(f"image holds grey values from {low:g} to {high:g}; they are too large")
    return values


def _one_channel(values: NDArray[Any]) -> NDArray[Any]:
    """Return the grey values of an image that is stored in colour; different channels are refused."""
    if values.ndim != 3 or values.shape[2] not in (1, 2, 3, 4) or min(values.shape[:2]) < FEWEST:
        return values
    channels = values.shape[2]
    colours = values[..., : channels - (channels in (2, 4))]  # the last of 2 or 4 is the opacity
    if (colours != colours[..., :1]).any():
        raise InvalidInput(
            f"image has shape {values.shape}: it is in colour, and its channels differ; pass one channel, "
            "such as image[..., 1], or the grey values of the camera"
        )
    return colours[..., 0]


def clipped(values: NDArray[Any]) -> tuple[NDArray[np.bool_] | None, NDArray[np.bool_] | None]:
    """Return which pixels are at the lower and at the upper end of the scale, None where no pixel is."""
    if values.dtype.kind not in "ui":
        return None, None
    low = values == 0 if values.min() == 0 else None
    largest = int(values.max())
    return low, values == largest if largest in FULL_SCALE else None


@dataclass(frozen=True)
class Options:
    """The arguments of `contact_areas`, checked; None where a value is to be measured."""

    pixel_size: float
    threshold: float | None = None
    dark_level: float | None = None
    blur: float | None = None
    subpixel: bool = True
    bright_contacts: bool = False
    smallest_area: float | None = None

    def __post_init__(self) -> None:
        refuse_missing("skimage", "images", "measuring contact areas")
        check.member(self, "pixel_size", above=0.0)
        check.member(self, "threshold", optional=True)
        check.member(self, "dark_level", optional=True)
        check.member(self, "blur", optional=True, at_least=0.0)
        check.member(self, "smallest_area", optional=True, at_least=0.0)
        for name in ("threshold", "dark_level"):
            value = getattr(self, name)
            if value is not None and value >= 1.0:
                raise InvalidInput(f"{name} = {value:g} must be below 1, the grey level of the ground")
        for name in ("subpixel", "bright_contacts"):
            if not isinstance(getattr(self, name), bool):
                raise InvalidInput(f"{name} = {shown(getattr(self, name))} must be True or False")
