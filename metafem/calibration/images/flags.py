"""Contacts that cannot be measured as they should be: at the frame's edge, merged, saturated."""

from __future__ import annotations

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.calibration.images.boundary import Contours
from metafem.calibration.images.ellipses import compactness
from metafem.calibration.images.grey import clipped

# Rows and columns of an image.
Window: TypeAlias = tuple[slice, ...]

# A contact is merged if its compactness is below this: that of two circles that touch is 0.89 to 0.95 if the
# radius of one is 1 to 0.3 of the other's. The boundary's noise changes it in second order alone.
COMPACT = 0.97

# Share of a contact's grey levels at an end of the scale above which it is saturated.
SATURATED = 0.01


def pixels_of(labels: NDArray[np.int32], windows: list[Window]) -> FloatArray:
    """Return the numbers of pixels of the regions 1, 2, ... in these windows."""
    counts = [np.count_nonzero(labels[window] == number) for number, window in enumerate(windows, 1)]
    return np.array(counts, dtype=np.float64)


def at_edge(window: Window, shape: tuple[int, ...], margin: int = 1) -> bool:
    """Whether a region of an image with a border comes within so many pixels of the frame's edge."""
    return any(s.start <= margin or s.stop >= n - margin for s, n in zip(window, shape, strict=True))


def merged(shape: Contours, labels: NDArray[np.int32], windows: list[Window]) -> NDArray[np.bool_]:
    """Return which regions are no ellipses, their holes filled."""
    compact = compactness(shape.area, shape.moment)
    for i in np.flatnonzero(shape.holes):
        compact[i] = _filled(labels[windows[i]] == i + 1)
    return np.asarray(compact < COMPACT)


def single(region: NDArray[np.bool_]) -> bool:
    """Whether the pixels of a region are those of one contact."""
    return _filled(region) >= COMPACT


def _filled(region: NDArray[np.bool_]) -> float:
    """Return the compactness of a region without its holes."""
    from scipy.ndimage import binary_fill_holes

    rows, columns = np.nonzero(binary_fill_holes(region))
    y, x = rows - rows.mean(), columns - columns.mean()
    # each pixel is a square, with moments of 1/12
    own = x.size / 12.0
    second = np.array([[np.sum(x * x) + own, np.sum(y * y) + own, np.sum(x * y)]])
    return float(compactness(np.array([float(x.size)]), second)[0])


def saturated(
    values: NDArray[Any], labels: NDArray[np.int32], size: FloatArray, bright_contacts: bool
) -> NDArray[np.bool_]:
    """Return which contacts have too many grey levels at an end of the scale; the ground counts for all.

    `size` holds the numbers of pixels of the contacts; `labels` have no border.
    """
    in_contact, on_ground = clipped(values)[:: -1 if bright_contacts else 1]
    result = np.zeros(size.size, dtype=bool)
    if in_contact is not None:
        result |= np.bincount(labels[in_contact], minlength=size.size + 1)[1:] > SATURATED * size
    if on_ground is not None:
        outside = np.count_nonzero(on_ground & (labels == 0))
        result |= bool(outside > SATURATED * (labels.size - size.sum()))
    return result
