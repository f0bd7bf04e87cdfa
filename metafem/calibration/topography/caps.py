"""Fit of spheres to the caps on a map, with the covariance of summit position, height and radius."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from metafem._validate import FloatArray
from metafem.calibration.topography.cells import HeightMap
from metafem.calibration.topography.correlation import correlation, summed
from metafem.calibration.topography.levelled import OUTLIER, SD_OF_MEDIAN, Levelling
from metafem.progress import each

# Lowest fraction of a cap's height, which the fit leaves out because tool and microscope round the foot.
FOOT = 0.1

# Largest number of steps of a fit, and number of first steps that update the circle of pixels. Four updates
# suffice if the initial guess is wrong by a tenth of the radius. With fixed pixels, the remaining steps
# converge quadratically.
ROUNDS, FOLLOWED = 20, 6

# A fit has converged if the last change of the height is at most this fraction of the standard error of the
# height. The standard error is computed for white noise, which gives the smallest possible value.
NEGLIGIBLE = 0.1

# Smallest number of pixels of a cap, five for each unknown.
FEWEST = 20

# Number of cells across a cap; residuals are summed in cells to compute their correlation.
ACROSS = 48

# Smallest standard deviation of the distances over the radius, the resolution of single precision.
RESOLUTION = float(np.finfo(np.float32).eps)

# Width of the margin around an outlier that the fit also leaves out [pixels].
BESIDE = 3


@dataclass(frozen=True)
class Cap:
    """Sphere on a map: centre x, y, height of the summit above the base plane, and radius [mm].

    `sd` is the standard deviation of the distances of the pixels from the sphere [mm], `used` the number of
    pixels, and `reach` the radius of the circle that contains them [mm]. `cause` is the reason why a fit
    failed.
    """

    x: float
    y: float
    height: float
    radius: float
    sd: float = 0.0
    used: int = 0
    reach: float = 0.0
    cause: str = ""

    def part(self, steepest: float) -> float:
        """Return the radius [mm] of the circle within which the cap is above its foot and not too steep."""
        height = (1.0 - FOOT) * self.height
        wide = max(height * (2.0 * self.radius - height), 0.0)
        steep = steepest / math.hypot(1.0, steepest) * self.radius
        return min(math.sqrt(wide), steep)


# Sums over the cells of a fit, (6, rows, columns), of the derivatives with respect to the four unknowns, the
# residuals and the weights; and the inverse of the normal matrix, (4, 4).
_Sums = tuple[FloatArray, FloatArray]


def fitted_caps(
    height_map: HeightMap, levelling: Levelling, starts: list[Cap], steepest: float
) -> tuple[list[Cap], FloatArray]:
    """Return the sphere fitted to each cap, and the covariance of (x, y, height, radius), (n, 4, 4).

    The fit minimises the squared distances from the sphere, integrated over the area of the sphere. Equal
    areas of a rough surface contain equal information, so the squared vertical residual of a pixel has the
    cosine of the slope as weight. Pixels with residuals above 4.5 robust standard deviations are excluded,
    together with their neighbours.
    """
    widest = max(cap.part(steepest) for cap in starts)
    side = max(1, round(2.0 * widest / ACROSS / max(height_map.pixel)))
    found = [
        _fitted(height_map, levelling, start, steepest, side)
        for start in each("fitting spheres: summit", starts)
    ]
    caps, sums = (list(column) for column in zip(*found, strict=True))
    covariance = np.full((len(caps), 4, 4), np.nan)
    good = [one[0] for one in sums if one is not None]
    if good:
        common = correlation([values[4] for values in good], [values[5] for values in good], 4)
        for i, fit in enumerate(sums):
            if fit is not None:
                values, inverse = fit
                variance = float((values[4] ** 2).sum() / (values[5] ** 2).sum())
                covariance[i] = inverse @ (variance * summed(values[:4], common)) @ inverse
    return caps, covariance


def _fitted(
    height_map: HeightMap, levelling: Levelling, start: Cap, steepest: float, side: int
) -> tuple[Cap, _Sums | None]:
    """Return one sphere fitted by Gauss-Newton steps, and its sums over cells."""
    cap = start
    rows, columns = height_map.window(np.array([cap.x, cap.y]), 1.2 * cap.part(steepest))
    x, y = height_map.x(columns)[None, :], height_map.y(rows)[:, None]
    z = height_map.heights(rows, columns) - levelling.base(x, y)
    known = np.isfinite(z)
    outlier = np.zeros(z.shape, dtype=bool)
    for number in range(ROUNDS):
        dx, dy = x - cap.x, y - cap.y
        square = dx**2 + dy**2
        if number < FOLLOWED:
            reach = cap.part(steepest)
            within = known & (square <= reach**2)
        used = within & ~outlier & (square < cap.radius**2)
        count = int(used.sum())
        if count < FEWEST:
            return replace(cap, cause=f"only {count} of its pixels were measured"), None
        # z = h - R + q with q = sqrt(R^2 - rho^2), and its derivatives with respect to x, y, h and R
        dx, dy = np.broadcast_to(dx, z.shape)[used], np.broadcast_to(dy, z.shape)[used]
        root = np.sqrt(cap.radius**2 - square[used])
        cosine = root / cap.radius
        matrix = np.array([dx / root, dy / root, np.ones(count), 1.0 / cosine - 1.0])
        distance = (z[used] - (cap.height - cap.radius + root)) * cosine
        inverse = np.linalg.inv((matrix * cosine) @ matrix.T)
        step = inverse @ (matrix @ distance)
        moved = Cap(*(np.array([cap.x, cap.y, cap.height, cap.radius]) + step).tolist())
        middle = float(np.median(distance))
        sd = SD_OF_MEDIAN * float(np.median(np.abs(distance - middle)))
        cap = replace(moved, sd=max(sd, RESOLUTION * cap.radius), used=count, reach=reach)
        if not 0.0 < cap.height < 2.0 * cap.radius:
            return replace(start, cause="its pixels do not lie on a sphere"), None
        if number and abs(step[2]) <= NEGLIGIBLE * cap.sd / math.sqrt(count):
            break
        if number < FOLLOWED:
            outlier = _outliers(z, known, x, y, cap)
    else:
        return replace(cap, cause=f"its sphere is not found in {ROUNDS} steps"), None
    residual = distance - (matrix.T @ step) * cosine
    return cap, (_summed(used, side, np.vstack([matrix, residual, np.ones(count)])), inverse)


def _outliers(
    z: FloatArray, known: NDArray[np.bool_], x: FloatArray, y: FloatArray, cap: Cap
) -> NDArray[np.bool_]:
    """Return a mask of the pixels that are too far from a sphere, and of their neighbours."""
    square = (x - cap.x) ** 2 + (y - cap.y) ** 2
    root = np.sqrt(np.maximum(cap.radius**2 - square, 0.0))
    distance = (z - (cap.height - cap.radius + root)) * root / cap.radius
    far = known & (np.abs(distance) > OUTLIER * cap.sd) & (square <= cap.reach**2)
    return np.asarray(binary_dilation(far, iterations=BESIDE) if far.any() else far)


def _summed(used: NDArray[np.bool_], side: int, values: FloatArray) -> FloatArray:
    """Return the sums over cells of values at pixels (m, pixels), (m, rows, columns)."""
    row, column = np.nonzero(used)
    cells = (-(-used.shape[0] // side), -(-used.shape[1] // side))
    cell = (row // side) * cells[1] + column // side
    return np.array([np.bincount(cell, each, cells[0] * cells[1]).reshape(cells) for each in values])


def pooled(value: FloatArray, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return (x, y, height, radius) of caps (n, 4) and their covariance (n, 4, 4) for one common radius.

    The common radius R is the mean of the radii R_i, weighted by their inverse variances. The other
    quantities v are corrected by their regression on the radius, ``v - C_vR / C_RR (R_i - R)``. Their
    variance then includes the error of R instead of the error of R_i.
    """
    variance = covariance[:, 3, 3]
    common = float((value[:, 3] / variance).sum() / (1.0 / variance).sum())
    own = 1.0 / float((1.0 / variance).sum())
    slope = covariance[:, :, 3] / variance[:, None]
    result = value - slope * (value[:, 3] - common)[:, None]
    outer = slope[:, :, None] * slope[:, None, :]
    return result, covariance - outer * variance[:, None, None] + outer * own
