"""Grey values of images, clipped pixels, and the options of the measurement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem import _validate as check
from metafem._extras import refuse_missing
from metafem._given import shown
from metafem.errors import InvalidInput, refuse_if

# Smallest number of pixels along the shorter side of an image, enough for one contact and the ground around
# it.
FEWEST = 16

# Largest possible grey levels. Pictures of cameras with 10 to 14 bits are stored with 16 bits.
FULL_SCALE = tuple(2**bits - 1 for bits in (8, 10, 12, 14, 16, 32))


def grey_values(image: Any) -> NDArray[Any]:
    """Return the grey values of an image, (rows, columns), row 0 at the top, in the original data type."""
    if isinstance(image, (str, bytes)) or hasattr(image, "__fspath__"):
        must = "is a name; it must be an array of grey values. `metafem images` reads files"
        raise InvalidInput(must, key="image", value=shown(image))
    try:
        values = np.asarray(np.ma.getdata(image) if not np.ma.is_masked(image) else None)
    except (TypeError, ValueError):
        raise InvalidInput(f"image = {shown(image)} must be an array of grey values") from None
    if values.dtype.kind not in "uif":
        raise InvalidInput(
            f"image must be an array of grey values without mask; its entries are {values.dtype}"
        )
    values = _one_channel(values)
    several = "; a stack of images is measured by stack_areas" if values.ndim > 2 else ""
    refuse_if(
        values.ndim != 2 or min(values.shape) < FEWEST,
        f"image has shape {values.shape}; it must be (rows, columns) with at least {FEWEST} of each{several}",
    )
    for row, column in np.argwhere(~np.isfinite(values))[:1].tolist():
        where = f"{values[row, column]} in row {row}, column {column}"
        raise InvalidInput(f"image holds {where}; all grey values must be finite")
    low, high = float(values.min()), float(values.max())
    same = f"all its grey values are {low:g}, all dark or all bright; it shows no contact"
    refuse_if(low == high, f"image is constant: {same}")
    large = not max(abs(low), abs(high)) < float(np.finfo(np.float32).max) / values.size
    refuse_if(large, f"image holds grey values from {low:g} to {high:g}; they are too large")
    return values


def _one_channel(values: NDArray[Any]) -> NDArray[Any]:
    """Return the grey values of an image stored in colour, or raise InvalidInput if its channels differ."""
    if values.ndim != 3 or values.shape[2] not in (1, 2, 3, 4) or min(values.shape[:2]) < FEWEST:
        return values
    channels = values.shape[2]
    colours = values[..., : channels - (channels in (2, 4))]  # of 2 or 4 channels, the last is the opacity
    refuse_if(
        (colours != colours[..., :1]).any(),
        f"image has shape {values.shape}: it is in colour, and its channels differ; pass one channel, such "
        "as image[..., 1], or the grey values of the camera",
    )
    return colours[..., 0]


def clipped(values: NDArray[Any]) -> tuple[NDArray[np.bool_] | None, NDArray[np.bool_] | None]:
    """Return masks of the pixels at the lower and the upper end of the scale; None for an empty mask."""
    if values.dtype.kind not in "ui":
        return None, None
    low = values == 0 if values.min() == 0 else None
    largest = int(values.max())
    return low, values == largest if largest in FULL_SCALE else None


@dataclass(frozen=True)
class Options:
    """Checked arguments of `contact_areas`; None for values that are to be measured."""

    pixel_size: float
    threshold: float | None = None
    dark_level: float | None = None
    blur: float | None = None
    bright_contacts: bool = False
    smallest_area: float | None = None

    def __post_init__(self) -> None:
        refuse_missing("skimage", "images", "measuring contact areas")
        check.member(self, "pixel_size", above=0.0)
        for name in ("blur", "smallest_area"):
            check.member(self, name, optional=True, at_least=0.0)
        for name in ("threshold", "dark_level"):
            check.member(self, name, optional=True)
            value = getattr(self, name) or 0.0
            refuse_if(value >= 1.0, "must be below 1, the grey level of the ground", key=name, value=value)
