"""Spheres fitted to the caps of a map, with the covariance of summit and radius."""

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

# Lowest share of a cap's height, which is left out because tool and microscope round the foot.
FOOT = 0.1

# Steps of a fit, and number of those in which the circle of pixels is updated. Four suffice if the initial
# guess is wrong by a tenth of the radius; with fixed pixels the other steps converge quadratically.
ROUNDS, FOLLOWED = 20, 6

# Last change of the height in a converged fit, over the standard error of the height for white noise with the
# standard deviation of the residuals, which is the smallest possible one.
NEGLIGIBLE = 0.1

# Fewest pixels of a cap, five for each unknown.
FEWEST = 20

# Number of cells across a cap in which residuals are summed for their correlation.
ACROSS = 48

# Smallest standard deviation of the distances over the radius: the resolution of single precision.
RESOLUTION = float(np.finfo(np.float32).eps)

# Number of pixels around an outlier that are left out as well.
BESIDE = 3


@dataclass(frozen=True)
class Cap:
    """A sphere on a map: centre x, y, height of the summit above the base plane, and radius [mm].

    `sd` is the standard deviation of the pixels' distances from the sphere, `used` their number and `reach`
    the radius of the circle that contains them [mm]; `cause` is the reason why a fit failed.
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
        """Return the radius of the circle [mm] above the foot and below the largest slope."""
        height = (1.0 - FOOT) * self.height
        wide = max(height * (2.0 * self.radius - height), 0.0)
        steep = steepest / math.hypot(1.0, steepest) * self.radius
        return min(math.sqrt(wide), steep)


# Of one fit: its derivatives by the four unknowns, residuals and weights, summed in cells (6, rows, columns),
# and the inverse of the normal matrix.
_Sums = tuple[FloatArray, FloatArray]


def fitted_caps(
    height_map: HeightMap, levelling: Levelling, starts: list[Cap], steepest: float
) -> tuple[list[Cap], FloatArray]:
    """Fit a sphere to each cap; return the caps and the covariance of (x, y, height, radius), (n, 4, 4).

    The squares of the distances from the sphere, per area of the sphere, are minimised: roughness varies
    along the surface, so that equal areas of it have equal information. The weight of the square of a pixel's
    vertical residual is therefore the cosine of the slope. Residuals above 4.5 robust standard deviations are
    excluded, with their neighbours.
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
    """Fit one sphere by Gauss-Newton steps."""
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
        # z = h - R + q with q = sqrt(R^2 - rho^2), and its derivatives by x, y, h and R
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
    """Return the pixels that are too far from a sphere, and their neighbours."""
    square = (x - cap.x) ** 2 + (y - cap.y) ** 2
    root = np.sqrt(np.maximum(cap.radius**2 - square, 0.0))
    distance = (z - (cap.height - cap.radius + root)) * root / cap.radius
    far = known & (np.abs(distance) > OUTLIER * cap.sd) & (square <= cap.reach**2)
    return np.asarray(binary_dilation(far, iterations=BESIDE) if far.any() else far)


def _summed(used: NDArray[np.bool_], side: int, values: FloatArray) -> FloatArray:
    """Return the sums of values at pixels (m, pixels) over cells."""
    row, column = np.nonzero(used)
    cells = (-(-used.shape[0] // side), -(-used.shape[1] // side))
    cell = (row // side) * cells[1] + column // side
    return np.array([np.bincount(cell, each, cells[0] * cells[1]).reshape(cells) for each in values])


def pooled(value: FloatArray, covariance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return (x, y, height, radius) of caps (n, 4) and their covariance (n, 4, 4) under one common radius.

    The radius is the mean weighted by the inverse variances. The others follow by their regression on it:
    ``v - C_vR / C_RR (R_i - R)``, and their variance no longer includes the error of the single radius.
    """
    variance = covariance[:, 3, 3]
    common = float((value[:, 3] / variance).sum() / (1.0 / variance).sum())
    own = 1.0 / float((1.0 / variance).sum())
    slope = covariance[:, :, 3] / variance[:, None]
    result = value - slope * (value[:, 3] - common)[:, None]
    outer = slope[:, :, None] * slope[:, None, :]
    return result, covariance - outer * variance[:, None, None] + outer * own
