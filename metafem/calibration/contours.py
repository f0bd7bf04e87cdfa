"""Contours of contacts at a grey level: areas, lengths, moments and ellipses, and the errors of areas.

Lengths are in pixels, and grey levels are divided by the contrast. A contact has the perimeter L and the
radius r. n is the noise of a pixel. The edge is a step blurred by a Gaussian of standard deviation s. The
image is smoothed again by a Gaussian of standard deviation w before the contour is found. The edge then has
the variance s_t² = s² + w² and the slope 1/(sqrt(2 pi) s_t) at the half level.

Noise. The smoothed noise over the slope is the displacement of the contour. The error of the area is the
integral of this displacement along the contour. Its variance is 2 pi s_t² L n²/(2 sqrt(pi) w), which has the
minimum 2 sqrt(pi) s L n² at w = s. This minimum is the Cramér-Rao bound for a straight edge of length L. The
Fisher information on the position of the edge is L/n² times the integral of the squared slope of the edge,
which gives L/(2 sqrt(pi) s n²), and the area changes by L times the displacement.

Curvature. Smoothing by s moves a contour of curvature kappa at the half level by s² kappa/2 towards its
centre of curvature. The curvature of a closed contour integrates to 2 pi. Therefore the area of any shape
shrinks by pi s², and grows by pi s² for each hole. For a circle, the half level follows from the median of
the noncentral chi-square distribution with two degrees of freedom; the next term is pi s² s²/(6 r²).

Level. An error d of the half level displaces the whole contour by d sqrt(2 pi) s_t.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_fill_holes

from metafem._validate import FloatArray, IntArray

# Polygons from marching squares lie inside smooth contours, because the interpolation is linear and the sides
# are chords. For any shape and blur, the lost area is pi times INTERPOLATION [pixels²]. The variance of an
# edge that is measured from its quarter levels is too large by EDGE_INTERPOLATION [pixels²] and, for a
# circle, by the relative amount EDGE_CURVATURE s_t²/r². The numbers were determined with circles of radius 15
# to 120 at random positions and s_t of 1.4 to 3.5.
INTERPOLATION, EDGE_INTERPOLATION, EDGE_CURVATURE = 0.21, 0.13, 0.5

# Compactness below which a contact counts as merged. Two touching circles whose radii have a ratio between 1
# and 0.3 have a compactness of 0.89 to 0.95. Noise of the boundary changes the compactness only in second
# order.
COMPACT = 0.97


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
    area than smooth contours (`INTERPOLATION`).
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


def single(region: NDArray[np.bool_]) -> bool:
    """Return whether a region, after its holes are filled, is one contact and not two merged ones."""
    rows, columns = np.nonzero(binary_fill_holes(region))
    y, x = rows - rows.mean(), columns - columns.mean()
    # each pixel is a square and contributes its own moment of 1/12
    own = x.size / 12.0
    second = np.array([[np.sum(x * x) + own, np.sum(y * y) + own, np.sum(x * y)]])
    return bool(compactness(np.array([float(x.size)]), second)[0] >= COMPACT)


def enclosed(area: FloatArray, holes: FloatArray | float, total: float) -> FloatArray:
    """Return the contact areas (n,) from the `area` within the contours at the half level; `total` is s_t."""
    variance = total**2 + INTERPOLATION
    return area + math.pi * variance * (1.0 - holes) + (math.pi * total**2) ** 2 / (6.0 * area)


def of_contour(
    length: FloatArray, noise: float, smoothing: float, total: float, level: float, blur: float
) -> FloatArray:
    """Return the standard deviations of areas (n,) from the noise and the errors of the level and of s_t."""
    from_noise = 2.0 * math.pi * total**2 * length * noise**2 / (2.0 * math.sqrt(math.pi) * smoothing)
    from_level = math.sqrt(2.0 * math.pi) * total * length * level
    from_blur = 2.0 * math.pi * total * blur
    return np.sqrt(from_noise + from_level**2 + from_blur**2)
