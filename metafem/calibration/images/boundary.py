"""Contours of contacts: areas, lengths, moments, ellipses, and detection of merged or cut contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_fill_holes

from metafem._validate import FloatArray, IntArray
from metafem.calibration.images.grey import clipped


@dataclass(frozen=True)
class Contours:
    """Contours of n regions [pixels]; x to the right, y upwards from the lower left corner of the frame.

    `area`, `length` and the number of `holes` are (n,), and `centre` is (n, 2). `moment` (n, 3) has the
    integrals of x², y² and xy over the region, about its centre.
    """

    area: FloatArray
    length: FloatArray
    centre: FloatArray
    moment: FloatArray
    holes: IntArray


def contours(image: NDArray[np.float32], labels: NDArray[np.int32], level: float, count: int) -> Contours:
    """Return the contours of the regions 1 to `count` at a level; the regions are darker than the level.

    Both arrays have a border of one ground pixel, so that all contours are closed. Dark pixels that touch
    only at a corner are not connected. The contours are polygons from marching squares; they enclose less
    area than smooth contours (`errors.INTERPOLATION`).
    """
    label, start, end, number = _sides(image, labels, level, count)

    def total(of: FloatArray) -> FloatArray:
        return np.asarray(np.bincount(label, of, count), dtype=np.float64)

    # coordinates relative to the mean of each region's contour points
    points = np.bincount(label, minlength=count)[:, None]
    origin = np.stack([total(column) for column in start.T], axis=1) / points
    p, q = start - origin[label], end - origin[label]
    # integrals over a polygon are sums over its sides
    (x0, y0), (x1, y1) = p.T, q.T
    cross = x0 * y1 - x1 * y0
    area = total(cross) / 2.0
    mean = np.stack([total((x0 + x1) * cross), total((y0 + y1) * cross)], axis=1) / (6.0 * area[:, None])
    moment = np.stack(
        [
            total((x0 * x0 + x0 * x1 + x1 * x1) * cross) / 12.0 - area * mean[:, 0] ** 2,
            total((y0 * y0 + y0 * y1 + y1 * y1) * cross) / 12.0 - area * mean[:, 1] ** 2,
            total((x0 * y1 + 2.0 * x0 * y0 + 2.0 * x1 * y1 + x1 * y0) * cross) / 24.0
            - area * mean[:, 0] * mean[:, 1],
        ],
        axis=1,
    )
    length = total(np.hypot(x1 - x0, y1 - y0))
    # each region has one outer contour; the others are holes
    return Contours(area, length, origin + mean, moment, number - 1)


def _sides(
    image: NDArray[np.float32], labels: NDArray[np.int32], level: float, count: int
) -> tuple[NDArray[np.intp], FloatArray, FloatArray, IntArray]:
    """Return region (m,) and ends (m, 2) of each contour side, and the number of contours of each region."""
    from skimage.measure import find_contours

    # pixels outside the regions count as bright
    dark = np.where(labels > 0, image, np.maximum(image, np.nextafter(np.float32(level), np.inf)))
    lines = find_contours(dark, level, fully_connected="high")  # type: ignore[no-untyped-call]
    owner = np.array([_owner(labels, line) for line in lines], dtype=np.intp) - 1
    sides = np.array([len(line) - 1 for line in lines], dtype=np.intp)
    # the border shifts the pixels by 1, and the centre of a pixel is at 0.5
    points = [np.stack([line[:, 1] - 0.5, image.shape[0] - 1.5 - line[:, 0]], axis=1) for line in lines]
    start = np.concatenate([np.zeros((0, 2)), *(line[:-1] for line in points)])
    end = np.concatenate([np.zeros((0, 2)), *(line[1:] for line in points)])
    return np.repeat(owner, sides), start, end, np.bincount(owner, minlength=count)


def _owner(labels: NDArray[np.int32], line: FloatArray) -> int:
    """Return the region of a contour, whose points lie between pixels of the region and of the ground."""
    before, after = (labels[tuple(pixel.astype(int).T)] for pixel in (np.floor(line), np.ceil(line)))
    return int(np.maximum(before, after).max())


def semi_axes(shape: Contours, total: float) -> tuple[FloatArray, FloatArray]:
    """Return the semi-axes (n, 2) and angles (n,) of the ellipses with the moments of the contacts.

    The contour lies inside the boundary of the contact by s_t²/2 times the curvature; `total` is s_t. For an
    ellipse with the semi-axes a along x and b along y, the integral of x² over the strip between contour and
    boundary is pi s_t² a³/(a + b).
    """
    xx, yy, xy = shape.moment.T
    middle, half = 0.5 * (xx + yy), np.hypot(0.5 * (xx - yy), xy)
    moments = np.stack([middle + half, np.maximum(middle - half, 0.0)], axis=1)
    axes = 2.0 * np.sqrt(moments / shape.area[:, None])
    lost = math.pi * total**2
    added = lost * axes**3 / axes.sum(axis=1, keepdims=True)
    whole = 2.0 * np.sqrt((moments + added) / (shape.area[:, None] + lost))
    return whole, 0.5 * np.arctan2(2.0 * xy, xx - yy)


def compactness(area: FloatArray, moment: FloatArray) -> FloatArray:
    """Return the squared ratio of the area to the area of the ellipse with the same moments, (n,).

    The area A of an ellipse is A² = 4 pi sqrt(M_xx M_yy - M_xy²). No other shape of this area has smaller
    moments, so the compactness is 1 for ellipses and smaller for all other shapes. It is 0.89 for two equal
    circles that touch, and 0.94 if their radii have the ratio 0.3.
    """
    xx, yy, xy = moment.T
    return np.asarray(area**2 / (4.0 * math.pi * np.sqrt(np.maximum(xx * yy - xy**2, np.finfo(float).tiny))))


# Rows and columns of an image that contain a region.
Window: TypeAlias = tuple[slice, ...]

# Compactness below which a contact counts as merged. Two touching circles whose radii have a ratio between 1
# and 0.3 have a compactness of 0.89 to 0.95. Noise of the boundary changes the compactness only in second
# order.
COMPACT = 0.97

# A contact counts as saturated if more than this share of its grey levels is at an end of the scale.
SATURATED = 0.01


def pixels_of(labels: NDArray[np.int32], windows: list[Window]) -> FloatArray:
    """Return the number of pixels of each region 1, 2, ..., from its window."""
    counts = [np.count_nonzero(labels[window] == number) for number, window in enumerate(windows, 1)]
    return np.array(counts, dtype=np.float64)


def at_edge(window: Window, shape: tuple[int, ...], margin: int = 1) -> bool:
    """Return whether a region is within `margin` pixels of the frame's edge; the image has a border."""
    return any(s.start <= margin or s.stop >= n - margin for s, n in zip(window, shape, strict=True))


def merged(shape: Contours, labels: NDArray[np.int32], windows: list[Window]) -> NDArray[np.bool_]:
    """Return which regions are less compact than a single contact after their holes are filled, (n,)."""
    compact = compactness(shape.area, shape.moment)
    for i in np.flatnonzero(shape.holes):
        compact[i] = _filled(labels[windows[i]] == i + 1)
    return np.asarray(compact < COMPACT)


def single(region: NDArray[np.bool_]) -> bool:
    """Return whether a region is a single contact and not two merged contacts."""
    return _filled(region) >= COMPACT


def _filled(region: NDArray[np.bool_]) -> float:
    """Return the compactness of a region after its holes are filled."""
    rows, columns = np.nonzero(binary_fill_holes(region))
    y, x = rows - rows.mean(), columns - columns.mean()
    # each pixel is a square and contributes its own moment of 1/12
    own = x.size / 12.0
    second = np.array([[np.sum(x * x) + own, np.sum(y * y) + own, np.sum(x * y)]])
    return float(compactness(np.array([float(x.size)]), second)[0])


def saturated(
    values: NDArray[Any], labels: NDArray[np.int32], size: FloatArray, bright_contacts: bool
) -> NDArray[np.bool_]:
    """Return which contacts are saturated, (n,); all of them if the ground is saturated.

    `size` holds the number of pixels of each contact. `labels` has no border.
    """
    in_contact, on_ground = clipped(values)[:: -1 if bright_contacts else 1]
    result = np.zeros(size.size, dtype=bool)
    if in_contact is not None:
        result |= np.bincount(labels[in_contact], minlength=size.size + 1)[1:] > SATURATED * size
    if on_ground is not None:
        outside = np.count_nonzero(on_ground & (labels == 0))
        result |= bool(outside > SATURATED * (labels.size - size.sum()))
    return result
