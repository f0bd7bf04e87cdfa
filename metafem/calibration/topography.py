"""Made surface on a map of heights: base plane, spheres of the caps, their sites in the design, errors."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import ndimage
from scipy.signal import correlate, fftconvolve

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import MICROMETRES, Value, percent, span
from metafem.calibration.sites import FEWEST as FEWEST_SITES
from metafem.calibration.sites import complex_points, match_sites, real_points, similarity
from metafem.caps import SPHERE
from metafem.errors import InvalidInput, refuse_if
from metafem.notes import Note, information
from metafem.progress import doing
from metafem.progress import each as told
from metafem.surface import Surface

# Ratio of the standard deviation of a normal variable to the median of its absolute value.
SD_OF_MEDIAN = 1.4826

# Distance from the base plane or from a sphere beyond which a value is an outlier, in standard deviations.
# For a normal variable, one value in 150,000 is farther away.
OUTLIER = 4.5

# Smallest number of pixels of a map along each axis. A cell is used if MEASURED of its pixels were measured.
FEWEST, MEASURED = 16, 0.1

# Number of cells across the smallest cap of the design in the search for summits. Summits are sought above
# LOWEST of the smallest height of the design, and above ABOVE robust standard deviations of the cells.
ACROSS, LOWEST, ABOVE = 10, 0.25, 6.0

# Smallest height of a cap over its radius [-]; 5 um for the paper's radius. Lower caps cannot be
# distinguished from roughness.
FLATTEST = 0.01

# Smallest number of cells of a cap, twice the number of unknowns; smaller hills are assumed to be dust. The
# initial guess of a sphere is fitted to the cells above UPPER of the height of a hill, without its foot.
# RADIUS_FACTOR is the largest ratio between its radius and that of the design.
CELLS, UPPER, RADIUS_FACTOR = 8, 0.3, 2.0

# Largest number of reweighting steps of the base plane; 15 suffice if 40 % of the cells are on caps. Smallest
# number of cells, five for each of six unknowns.
STEPS, PLANE_CELLS = 50, 30

# Powers of x and y of a plane with bow; the first three are those of a plane.
POWERS = ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2))

# Largest slope at which a cap is used [-], 45 degrees; microscopes do not see steeper flanks.
STEEPEST = 1.0

# Lowest fraction of a cap's height, which the fit leaves out because tool and microscope round the foot.
FOOT = 0.1

# Largest number of steps of a sphere's fit, and number of first steps that update the circle of pixels. Four
# updates suffice if the guess is wrong by a tenth of the radius; then steps converge quadratically.
ROUNDS, FOLLOWED = 20, 6

# A fit has converged if the last change of the height is at most this fraction of its standard error for
# white noise, the smallest possible one. Smallest number of pixels of a cap, five for each unknown.
NEGLIGIBLE, PIXELS = 0.1, 20

# Number of cells across a cap, in which residuals are summed to compute their correlation; margin around an
# outlier that the fit also leaves out [pixels]; smallest standard deviation of the distances over the radius,
# the resolution of single precision.
SUMMED, BESIDE, RESOLUTION = 48, 3, float(np.finfo(np.float32).eps)

# Largest angle between the axes of the map and the axes of the part, in addition to quarter turns. The
# heights decide between two orientations if the ratio of their height misfits exceeds DECIDED.
TURN, DECIDED = math.radians(20.0), 1.5

# Largest relative error of distances on the map without a note, typical of microscopes.
SCALE = 2e-3

# A note is added if the standard deviation of the height errors exceeds FOREIGN of the standard deviation and
# FOREIGN_MEAN of the mean of the designed heights. Manufacturing errors are a few percent; if the map shows
# another part, the errors are as large as the differences between heights.
FOREIGN, FOREIGN_MEAN = 0.5, 0.05

# Largest number of caps, hills or missing asperities whose places a note lists.
NAMED = 5


@dataclass(frozen=True, eq=False)
class HeightMap:
    """Heights [mm] of pixels, (rows, columns), nan where not measured, and the size of the pixels [mm].

    The origin is the lower left corner of the map. y points upwards, and the first row is at the top. `sign`
    is -1 for the map of a mould.
    """

    values: NDArray[np.floating]
    pixel: tuple[float, float]
    sign: float = 1.0

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height of the map [mm]."""
        rows, columns = self.values.shape
        return self.pixel[0] * columns, self.pixel[1] * rows

    def x(self, columns: slice) -> FloatArray:
        """Return the x coordinates of the centres of columns [mm]."""
        return self.pixel[0] * (np.arange(columns.start, columns.stop) + 0.5)

    def y(self, rows: slice) -> FloatArray:
        """Return the y coordinates of the centres of rows [mm]."""
        return self.pixel[1] * (len(self.values) - np.arange(rows.start, rows.stop) - 0.5)

    def window(self, centre: FloatArray, reach: float) -> tuple[slice, slice]:
        """Return the rows and columns of the square window with half-width `reach` [mm] about a point."""
        rows, columns = self.values.shape
        column = np.rint((centre[0] + np.array([-reach, reach])) / self.pixel[0])
        row = np.rint(rows - (centre[1] + np.array([reach, -reach])) / self.pixel[1])
        (left, right), (top, bottom) = np.clip(column, 0, columns), np.clip(row, 0, rows)
        return slice(int(top), int(bottom)), slice(int(left), int(right))

    def heights(self, rows: slice, columns: slice) -> FloatArray:
        """Return the heights in a window in double precision [mm]; values that are not finite become nan."""
        found = np.asarray(self.sign * self.values[rows, columns].astype(np.float64))
        found[~np.isfinite(found)] = np.nan
        return found


class Cells(NamedTuple):
    """Mean heights of the cells of a map, (rows, columns), nan where not measured, and their coordinates."""

    mean: FloatArray
    x: FloatArray
    y: FloatArray
    size: float


def cells(
    height_map: HeightMap, side: int, expected: Callable[[slice, slice], FloatArray] | None = None
) -> Cells:
    """Return means over cells of `side` x `side` pixels, without incomplete cells at the right and bottom.

    `expected` returns heights for rows and columns that are subtracted from the pixels [mm].
    """
    rows, columns = (length // side for length in height_map.values.shape)
    mean, across = np.empty((rows, columns)), slice(0, columns * side)
    for i in told("reading the map", range(rows)):
        band = slice(i * side, (i + 1) * side)
        heights = height_map.heights(band, across) - (0.0 if expected is None else expected(band, across))
        blocks = heights.reshape(side, columns, side)
        count = np.isfinite(blocks).sum(axis=(0, 2))
        mean[i] = np.where(
            count >= MEASURED * side**2, np.nansum(blocks, axis=(0, 2)) / np.maximum(count, 1), np.nan
        )
    width, height = side * height_map.pixel[0], side * height_map.pixel[1]
    y = height_map.pixel[1] * len(height_map.values) - height * (np.arange(rows) + 0.5)
    return Cells(mean, width * (np.arange(columns) + 0.5), y, max(width, height))


@dataclass(frozen=True, eq=False, repr=False)
class Levelling(Value):
    """Base plane that was subtracted from a map; coordinates are relative to the centre of the map.

    Attributes
    ----------
    centre : ndarray, (2,)
        Centre of the map, relative to its lower left corner [mm].
    extent : float
        Half of the larger side of the map [mm].
    tilt : ndarray, (2,)
        Slopes along x and y [rad].
    bow : ndarray, (3,)
        Coefficients of x^2, x y and y^2 [1/mm]; zeros if only the tilt was removed.
    offset : float
        Height of the base plane at the centre of the map [mm].
    sd : float
        Robust standard deviation of the mean heights of cells about the base plane [mm].
    covariance : ndarray
        Covariance of the coefficients of the powers of (x, y) / extent [mm^2].
    """

    centre: FloatArray
    extent: float
    tilt: FloatArray
    bow: FloatArray
    offset: float
    sd: float
    covariance: FloatArray

    def base(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the height of the base plane at points on the map [mm]."""
        u, v = x - self.centre[0], y - self.centre[1]
        bow = self.bow[0] * u**2 + self.bow[1] * u * v + self.bow[2] * v**2
        return np.asarray(self.offset + self.tilt[0] * u + self.tilt[1] * v + bow)

    def base_sd(self, x: FloatArray, y: FloatArray) -> FloatArray:
        """Return the standard deviation of the base plane at points on the map, (n,) [mm]."""
        rows = _powers((x - self.centre[0]) / self.extent, (y - self.centre[1]) / self.extent, bowed=True)
        rows = rows[: len(self.covariance)]
        return np.asarray(np.sqrt(np.einsum("kn,kl,ln->n", rows, self.covariance, rows)))


def levelled(
    height_map: HeightMap, found: Cells, bowed: bool, caps: NDArray[np.bool_] | None = None
) -> Levelling:
    """Return the base plane, fitted to the mean heights of cells.

    If `caps` is None, all cells are fitted. The fit starts with least absolute deviations and continues with
    least squares over the cells within 4.5 robust standard deviations of the plane. Only the cells below the
    plane determine this standard deviation, because the caps lie above it. If `caps` marks the cells on caps,
    only the other cells are fitted, and outliers on both sides are excluded.
    """
    rows, columns = height_map.values.shape
    centre = 0.5 * np.array(height_map.pixel) * np.array([columns, rows])
    extent = float(centre.max())
    u, v = np.meshgrid((found.x - centre[0]) / extent, (found.y - centre[1]) / extent)
    known = np.isfinite(found.mean) if caps is None else np.isfinite(found.mean) & ~caps
    count = 6 if bowed else 3
    few = int(known.sum())
    text = f"the map has {few} cells of {found.size:.3g} mm with heights between its summits; at least"
    refuse_if(few < PLANE_CELLS, f"{text} {PLANE_CELLS} are needed for the base plane")
    values = found.mean[known]
    matrix = _powers(u[known], v[known], bowed)
    inside = np.ones(len(values), dtype=bool)
    weight = np.ones(len(values))
    sd = 0.0
    for step in range(STEPS):
        weighted = matrix * (weight * inside)
        fit = np.linalg.lstsq(weighted @ matrix.T, weighted @ values, rcond=None)[0]
        residual = values - fit @ matrix
        if caps is None and step < STEPS // 2:  # least absolute deviations
            weight = 1.0 / np.maximum(np.abs(residual), 1e-3 * np.abs(residual).mean() + 1e-300)
            continue
        weight[:] = 1.0
        middle = float(np.median(residual[inside]))
        below = residual[residual <= middle] if caps is None else residual[inside]
        sd = SD_OF_MEDIAN * float(np.median(np.abs(below - middle)))
        before, inside = inside, np.abs(residual - middle) <= OUTLIER * sd
        if (before == inside).all():
            break
    lie = "its cells between the summits do not lie on one"
    refuse_if(inside.sum() < PLANE_CELLS, f"the map holds no base plane: {lie}")
    grids = np.zeros((count + 2, *found.mean.shape))
    grids[:, known] = np.vstack([matrix * inside, np.where(inside, residual, 0.0), inside])
    columns, errors, weights = grids[:count], grids[count], grids[count + 1]
    bread = np.linalg.inv(np.einsum("kij,lij->kl", columns, columns))
    variance = float((residual[inside] ** 2).mean())
    meat = summed(columns, correlation([errors], [weights], count)) * variance
    scale = extent ** -np.array([sum(power) for power in POWERS[:count]], dtype=float)
    coefficient = np.zeros(6)
    coefficient[:count] = fit * scale
    return Levelling(
        centre, extent, coefficient[1:3], coefficient[3:], float(coefficient[0]), sd, bread @ meat @ bread
    )  # fmt: skip


def _powers(u: FloatArray, v: FloatArray, bowed: bool) -> FloatArray:
    return np.array([u**i * v**j for i, j in POWERS[: 6 if bowed else 3]])


def correlation(sums: Sequence[FloatArray], weights: Sequence[FloatArray], parameters: int) -> FloatArray:
    """Return the common autocorrelation of residuals on several grids, (2 reach + 1, 2 reach + 1).

    The correlation is the covariance at each lag [cells], divided by the variance of the residuals. At lag 0
    it exceeds 1, because a fit reduces the variance of its residuals. The sum of the correlation over all
    lags is the number of cells per independent value.

    `sums` holds the sum of the residuals in each cell, `weights` their number, and `parameters` the number of
    fitted parameters of each grid. Lags are included up to the first ring of lags with a mean covariance of
    at most 0. The fit reduces the covariance at each lag by ``parameters S / N``, with the sum S over all
    lags and the number N of cells. This reduction is added back.
    """
    reach = max(1, min(max(each.shape) for each in weights) // 2)
    total, pairs = np.zeros((2 * reach + 1,) * 2), np.zeros((2 * reach + 1,) * 2)
    count = 0.0
    for each, weight in zip(sums, weights, strict=True):
        total += lagged(each, each, reach)
        pairs += lagged(weight, weight, reach)
        count += weight.sum() ** 2 / (weight**2).sum()
    covariance = np.divide(total, pairs, out=np.zeros_like(total), where=pairs > 0.5)
    lag = np.arange(-reach, reach + 1)
    ring = np.rint(np.hypot(lag, lag[:, None])).astype(np.intp)
    mean = np.bincount(ring.ravel(), covariance.ravel()) / np.bincount(ring.ravel())
    vanished = np.flatnonzero(mean[: reach + 1] <= 0.0)
    cut = int(vanished[0]) if vanished.size else reach + 1
    inside = ring < cut
    taken = parameters * len(weights) / count  # reduction at each lag, divided by the sum S
    whole = covariance[inside].sum() / max(1.0 - taken * inside.sum(), taken)
    variance = covariance[reach, reach]
    if not variance > 0.0:  # exact data have no residuals
        return np.ones((1, 1))
    covariance = np.where(inside, covariance + taken * whole, 0.0)
    keep = slice(reach - cut, reach + cut + 1) if cut <= reach else slice(None)
    return np.asarray(covariance[keep, keep] / variance)


def summed(columns: FloatArray, correlation: FloatArray) -> FloatArray:
    """Return ``sum_ij X_ik c(i - j) X_jl`` for columns X (p, rows, columns) on a grid, (p, p)."""
    spread = fftconvolve(columns, correlation[None], mode="same", axes=(1, 2))
    return np.asarray(np.einsum("kij,lij->kl", columns, spread))


def lagged(one: FloatArray, other: FloatArray, reach: int) -> FloatArray:
    """Return ``sum_i a_i b_{i + lag}`` for all lags up to `reach` along both axes."""
    return np.asarray(correlate(np.pad(other, reach), one, mode="valid", method="fft"))


@dataclass(frozen=True)
class Cap:
    """Sphere on a map: centre x, y, height of the summit above the base plane, and radius [mm].

    `sd` is the standard deviation of the distances of the pixels from the sphere [mm], and `cause` the reason
    why a fit failed.
    """

    x: float
    y: float
    height: float
    radius: float
    sd: float = 0.0
    cause: str = ""

    @property
    def part(self) -> float:
        """Return the radius [mm] of the circle within which the cap is above its foot and not too steep."""
        height = (1.0 - FOOT) * self.height
        wide = max(height * (2.0 * self.radius - height), 0.0)
        steep = STEEPEST / math.hypot(1.0, STEEPEST) * self.radius
        return min(math.sqrt(wide), steep)


def hills(
    found: Cells, levelling: Levelling, lowest: float, radius: float
) -> tuple[NDArray[np.bool_], list[Cap], list[tuple[float, float]]]:
    """Return a mask of the cells on hills, initial guesses of caps, and the centres of other hills [mm].

    The mask includes a margin. `lowest` is the smallest height of a cap, `radius` the radius of the design
    [mm].
    """
    x, y = np.meshgrid(found.x, found.y)
    above = found.mean - levelling.base(x, y)
    with np.errstate(invalid="ignore"):
        high = above > max(ABOVE * levelling.sd, lowest)
    # close holes in the flanks
    closed = ndimage.binary_closing(high, iterations=2) | high
    label, _ = ndimage.label(closed, np.ones((3, 3)))
    starts, other = [], []
    for number, window in enumerate(ndimage.find_objects(label), 1):
        own = (label[window] == number) & np.isfinite(above[window])
        at = x[window][own], y[window][own], above[window][own]
        guess = _sphere(*at) if own.sum() >= CELLS else None
        if guess is not None and radius / RADIUS_FACTOR <= guess.radius <= radius * RADIUS_FACTOR:
            starts.append(guess)
        else:
            other.append((float(at[0].mean()), float(at[1].mean())))
    # margin: one cell for the foot of a hill below the threshold, and one for the closing
    return np.asarray(ndimage.binary_dilation(closed, np.ones((3, 3)), iterations=2)), starts, other


def _sphere(x: FloatArray, y: FloatArray, z: FloatArray) -> Cap | None:
    """Return the least-squares sphere ``|p|^2 - 2 c p - (R^2 - |c|^2) = 0``, or None if invalid."""
    upper = z > UPPER * z.max()
    if upper.sum() < CELLS:
        return None
    middle = np.array([x[upper].mean(), y[upper].mean(), 0.0])
    points = np.column_stack([x[upper], y[upper], z[upper]]) - middle
    matrix = np.column_stack([2.0 * points, np.ones(len(points))])
    solved = np.linalg.lstsq(matrix, (points**2).sum(axis=1), rcond=None)[0]
    centre, square = solved[:3], solved[3] + (solved[:3] ** 2).sum()
    if square <= 0.0:
        return None
    radius = float(np.sqrt(square))
    cx, cy, cz = (centre + middle).tolist()
    return Cap(cx, cy, cz + radius, radius) if 0.0 < cz + radius < 2.0 * radius else None


def fitted_caps(
    height_map: HeightMap, levelling: Levelling, starts: list[Cap]
) -> tuple[list[Cap], FloatArray]:
    """Return the sphere fitted to each cap, and the covariance of (x, y, height, radius), (n, 4, 4).

    The fit minimises the squared distances from the sphere, integrated over the area of the sphere. Equal
    areas of a rough surface contain equal information, so the squared vertical residual of a pixel has the
    cosine of the slope as weight. Pixels with residuals above 4.5 robust standard deviations are excluded,
    together with their neighbours.
    """
    widest = max(cap.part for cap in starts)
    side = max(1, round(2.0 * widest / SUMMED / max(height_map.pixel)))
    found = [_fitted(height_map, levelling, start, side) for start in told("fitting spheres: summit", starts)]
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
    height_map: HeightMap, levelling: Levelling, start: Cap, side: int
) -> tuple[Cap, tuple[FloatArray, FloatArray] | None]:
    """Return one sphere fitted by Gauss-Newton steps, and its sums over cells."""
    cap = start
    rows, columns = height_map.window(np.array([cap.x, cap.y]), 1.2 * cap.part)
    x, y = height_map.x(columns)[None, :], height_map.y(rows)[:, None]
    z = height_map.heights(rows, columns) - levelling.base(x, y)
    known = np.isfinite(z)
    outlier = np.zeros(z.shape, dtype=bool)
    for number in range(ROUNDS):
        dx, dy = x - cap.x, y - cap.y
        square = dx**2 + dy**2
        if number < FOLLOWED:
            reach = cap.part
            within = known & (square <= reach**2)
        used = within & ~outlier & (square < cap.radius**2)
        count = int(used.sum())
        if count < PIXELS:
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
        cap = replace(moved, sd=max(sd, RESOLUTION * cap.radius))
        if not 0.0 < cap.height < 2.0 * cap.radius:
            return replace(start, cause="its pixels do not lie on a sphere"), None
        if number and abs(step[2]) <= NEGLIGIBLE * cap.sd / math.sqrt(count):
            break
        if number < FOLLOWED:
            outlier = _outliers(z, known, x, y, cap, reach)
    else:
        return replace(cap, cause=f"its sphere is not found in {ROUNDS} steps"), None
    residual = distance - (matrix.T @ step) * cosine
    return cap, (_summed(used, side, np.vstack([matrix, residual, np.ones(count)])), inverse)


def _outliers(
    z: FloatArray, known: NDArray[np.bool_], x: FloatArray, y: FloatArray, cap: Cap, reach: float
) -> NDArray[np.bool_]:
    """Return a mask of the pixels that are too far from a sphere, and of their neighbours."""
    square = (x - cap.x) ** 2 + (y - cap.y) ** 2
    root = np.sqrt(np.maximum(cap.radius**2 - square, 0.0))
    distance = (z - (cap.height - cap.radius + root)) * root / cap.radius
    far = known & (np.abs(distance) > OUTLIER * cap.sd) & (square <= reach**2)
    return np.asarray(ndimage.binary_dilation(far, iterations=BESIDE) if far.any() else far)


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


@dataclass(frozen=True, eq=False)
class Alignment:
    """Sites of summits (m,), -1 for no site, and their positions in the design's coordinates (m, 2) [mm].

    `rotation` is the angle of the part on the map, anticlockwise [rad]. `scale` is the ratio of distances on
    the map to distances in the design. `misfit` is the standard deviation of the height errors [mm]. If
    `decided` is false, another orientation or shift of the part fits the heights nearly as well.
    """

    site: NDArray[np.intp]
    position: FloatArray
    rotation: float
    mirrored: bool
    scale: float
    misfit: float
    decided: bool = True

    @property
    def matched(self) -> int:
        """Number of summits with a site."""
        return int((self.site >= 0).sum())


def aligned(centre: FloatArray, height: FloatArray, design: Surface, mirrored: bool) -> Alignment:
    """Return the alignment of summits (m, 2) with heights (m,) to the sites of a design.

    All quarter turns are compared. `mirrored` states whether the map is mirrored. The turn with the largest
    number of matched summits is used. If several turns match this number, the heights decide.
    """
    if min(len(centre), design.count) < FEWEST_SITES:
        return _few(centre, height, design)
    found, refused = [], []
    for quarter in range(4):
        angle, side = 0.5 * math.pi * quarter, "block" if mirrored else "glass"
        try:
            match = match_sites(
                centre, design.position, viewed_from=side, rotation=angle, rotation_range=TURN
            )
        except InvalidInput as error:
            refused.append(str(error).replace("contacts", "caps").replace("in the image", "on the map"))
            continue
        on_site = match.site >= 0
        points, wanted = complex_points(centre, mirrored), design.position[match.site[on_site]]
        factor, _ = similarity(complex_points(wanted), points[on_site])
        factor /= abs(factor)  # a rigid motion: the scale of the map is kept
        moved = factor * (points - points[on_site].mean()) + complex_points(wanted).mean()
        misfit = float((height[on_site] - design.height[match.site[on_site]]).std())
        turned = float(np.angle(factor)) * (1.0 if mirrored else -1.0)
        place = match.site, real_points(moved), turned, mirrored, match.scale, misfit, not match.ambiguous
        found.append(Alignment(*place))
    if not found:
        raise InvalidInput(refused[0])
    most = max(one.matched for one in found)
    found = [one for one in found if one.matched == most]
    best = min(found, key=lambda one: one.misfit)
    near = [one for one in found if one.misfit <= DECIDED * best.misfit]
    others = any((one.site != best.site).any() for one in near)
    return replace(near[0], decided=False) if others else best  # the first orientation tried


def _few(centre: FloatArray, height: FloatArray, design: Surface) -> Alignment:
    """Return the alignment of one or two summits to as many sites, by the order of their coordinates."""
    refuse_if(
        len(centre) != design.count,
        f"the map shows {len(centre)} caps and the design has {design.count} asperities; at least "
        f"{FEWEST_SITES} of each are needed to match them",
    )
    site = np.empty(design.count, dtype=np.intp)
    axis = int(np.abs(centre[-1] - centre[0]).argmax())
    site[np.argsort(centre[:, axis])] = np.argsort(design.position[:, axis])
    position = centre - centre.mean(axis=0) + design.position.mean(axis=0)
    return Alignment(site, position, 0.0, False, 1.0, float((height - design.height[site]).std()))


def placement_notes(
    design: Surface, centre: FloatArray, place: Alignment, missing: IntArray, other: list[tuple[float, float]]
) -> Iterator[Note]:
    """Return notes on unmatched summits, missing asperities, and rotation, mirroring or scale of the map."""
    for what, places in (
        ("caps of the map have no site in the design", centre[place.site < 0].tolist()),
        ("hills of the map are no caps of the design", other),
        ("asperities of the design are missing on the map", design.position[missing].tolist()),
    ):
        if places:
            first = ", ".join(on_map(*at) for at in places[:NAMED])
            yield Note(f"{len(places)} {what}: {first}" + " and others" * (len(places) > NAMED))
    height = design.height[place.site[place.site >= 0]]
    if place.misfit > FOREIGN * height.std() and place.misfit > FOREIGN_MEAN * height.mean():
        yield Note(
            "the heights of the caps are not those of the design: their errors have the standard deviation "
            f"{place.misfit:g} mm, the designed heights {height.std():g} mm; check the design, and whether "
            "the map shows the mould"
        )
    turn = round(math.degrees(place.rotation) / 90.0) % 4 * 90
    if not place.decided:
        yield information(
            "the heights do not show how the part was turned or shifted; the map is used as it is"
        )
    elif turn:
        yield information(f"by its heights, the part is turned by {turn} degrees on the map")
    if abs(place.scale - 1.0) > SCALE:
        larger = percent(place.scale - 1.0, "+.2g")
        yield Note(f"distances on the map differ from the design's by {larger}; check pixel_size")


def on_map(x: float, y: float) -> str:
    """Return the coordinates of a point on a map as text."""
    return f"({x:.3f}, {y:.3f}) mm"


@dataclass(frozen=True, eq=False, repr=False)
class MadeSurface(Value):
    """Measured surface of a part, and its design.

    Attributes
    ----------
    surface : Surface
        Asperities that were found, with heights above the base plane, radii, and positions in the design's
        coordinates. The design provides material, friction and block.
    design : Surface
        Designed surface.
    site : ndarray of int, (n,)
        Number of the design's asperity for each measured asperity.
    height_sd, radius_sd, position_sd : ndarray, (n,)
        Standard deviations of height, radius and each position coordinate [mm].
    levelling : Levelling
        Tilt and bow that were subtracted.
    missing : ndarray of int
        Numbers of the design's asperities that were not found.
    roughness : float
        Standard deviation of the pixels' distances from the spheres [mm].
    rotation : float
        Angle of the part on the map, anticlockwise, including quarter turns [rad].
    mirrored : bool
        Whether the map is a mirror image of the part.
    on_map : ndarray, (n, 2)
        Positions of the summits on the map, relative to its lower left corner [mm].
    notes : tuple of Note
    height_error, radius_error : ndarray, (n,)
        Made minus designed [mm].
    position_error : ndarray, (n, 2)
        Made minus designed [mm].

    Examples
    --------
    >>> import metafem as mf
    >>> design = mf.Surface([[0.0, 0.0]], [0.1], 0.526, mf.Material(1.36))
    >>> x = 0.004 * (np.arange(300) - 149.5)
    >>> cap = np.sqrt(np.maximum(0.526**2 - x**2 - x[:, None] ** 2, 0.425**2)) - 0.425
    >>> made = mf.calibration.made_surface(cap, 0.004, design)
    >>> made.height_error.round(6), made.missing
    (array([0.001]), array([], dtype=int64))
    """

    surface: Surface
    design: Surface
    site: IntArray
    height_sd: FloatArray
    radius_sd: FloatArray
    position_sd: FloatArray
    levelling: Levelling
    missing: IntArray
    roughness: float
    rotation: float
    mirrored: bool
    on_map: FloatArray
    notes: tuple[Note, ...] = ()

    @property
    def height_error(self) -> FloatArray:
        """Made minus designed heights, (n,) [mm]."""
        return self.surface.height - self.design.height[self.site]

    @property
    def radius_error(self) -> FloatArray:
        """Made minus designed radii, (n,) [mm]."""
        return self.surface.radius - self.design.radius[self.site]

    @property
    def position_error(self) -> FloatArray:
        """Made minus designed positions, (n, 2) [mm]."""
        return self.surface.position - self.design.position[self.site]

    def __repr__(self) -> str:
        error = MICROMETRES * self.height_error
        return (
            f"<MadeSurface: {self.surface.count} of {self.design.count} asperities, height error "
            f"{error.mean():.3g} um on average with s.d. {error.std():.3g} um, radius "
            f"{span(self.surface.radius, 'mm')}>"
        )


def made_surface(
    height_map: ArrayLike,
    pixel_size: float | tuple[float, float],
    design_surface: Surface,
    *,
    bow: bool = True,
    common_radius: bool = False,
    mould: bool = False,
) -> MadeSurface:
    """Return the made surface: heights, radii and positions of the asperities on a map of heights.

    The base plane (tilt and bow) is fitted between the caps. A sphere ``z = h - R + sqrt(R^2 - rho^2)`` is
    fitted to the part of each cap that belongs to the upper nine tenths of its height and has a slope below
    1. This large part is used because it contains the most information. For roughness with the
    standard deviation s and the covariance ``s^2 exp(-r^2/l^2)`` on a circle of radius a, the standard errors
    are ``2 s l/a`` for the height, ``4 sqrt(3) s l R^2/a^3`` for the radius and ``2 s l R/a^2`` for each
    coordinate, to first order in a/R and l/a. No unbiased estimate is better by more than terms of order l/a.
    For caps 0.05 to 0.27 mm high with R = 0.526 mm and an arithmetic roughness of 1.2 um, the root mean
    square error of the heights is at most 0.1 um up to l = 12 um, or up to l = 23 um with a common radius.
    The returned standard errors are computed from the correlation of the measured residuals.

    Parameters
    ----------
    height_map : array_like, (rows, columns)
        Heights [mm], nan where not measured. As in an image, columns run along x and rows downwards along -y.
    pixel_size : float or (float, float)
        Distance between the centres of neighbouring pixels [mm], or the two distances along x and y.
    design_surface : Surface
        Designed surface, with the sites and the size of the caps.
    bow : bool
        Whether to subtract a second-order surface instead of a plane; default: True. This also subtracts a
        bow of the part itself. A block glued to glass has no bow, but a free block may have one.
    common_radius : bool
        Whether all caps have the same radius, for example because one tool made them; default: False. A
        common radius halves the errors of the heights.
    mould : bool
        Whether the map shows the mould, whose holes form the caps, so that it is a mirror image of the part;
        default: False.

    Returns
    -------
    MadeSurface

    Raises
    ------
    InvalidInput
        If the map is too small or shows no base plane, if it shows no cap with a radius within a factor of
        two of the design's radius, if no cap lies on a site, or if the caps of the design are not spheres.

    Notes
    -----
    ISO 25178-2 defines the autocorrelation length of a surface as the distance of the fastest decay of the
    autocorrelation to 0.2. For the covariance above it is 1.27 l. For the least-squares fit of spheres see
    Forbes, NPL Report DITC 140/89 (1991).

    Examples
    --------
    >>> import metafem as mf
    >>> design = mf.Surface([[0.0, 0.0]], [0.1], 0.526, mf.Material(1.36))
    >>> x = 0.004 * (np.arange(300) - 149.5)
    >>> cap = np.sqrt(np.maximum(0.526**2 - x**2 - x[:, None] ** 2, 0.426**2)) - 0.426
    >>> made = mf.calibration.made_surface(cap + 0.002 * x, 0.004, design)
    >>> made.surface.height.round(6), made.surface.radius.round(6)
    (array([0.1]), array([0.526]))
    """
    check.instance("design_surface", design_surface, Surface, "a metafem.Surface")
    picture = _height_map(height_map, pixel_size, mould)
    design = design_surface
    refuse_if(
        design.cap != SPHERE,
        f"must be {SPHERE!r}: spheres are fitted to the map. Measure summits of other caps by other means, "
        "and set their heights by surface.replaced(height=...)",
        key="design_surface.cap",
        value=repr(design.cap),
    )
    with doing("measuring the surface"):
        level, every, covariance, other = _spheres(picture, design, bow, mould)
    caps = [cap for cap in every if not cap.cause]
    notes = [
        Note(f"the cap at {on_map(cap.x, cap.y)} on the map was not measured: {cap.cause}")
        for cap in every
        if cap.cause
    ]
    if not caps:
        raise InvalidInput(f"the map shows no cap that can be measured; {notes[0].text}")
    covariance = covariance[[not cap.cause for cap in every]]
    value = np.array([[cap.x, cap.y, cap.height, cap.radius] for cap in caps])
    if common_radius:
        value, covariance = pooled(value, covariance)
    place = aligned(value[:, :2], value[:, 2], design, mould)
    matched = np.flatnonzero(place.site >= 0)
    refuse_if(not matched.size, f"none of the {len(caps)} caps of the map lies on a site of the design")
    order = matched[np.argsort(place.site[matched])]
    site = place.site[order].astype(np.int64)
    missing = np.setdiff1d(np.arange(design.count), site)
    notes += placement_notes(design, value[:, :2], place, missing, other)
    x, y, height, radii = value[order].T
    variance = np.diagonal(covariance[order], axis1=1, axis2=2)
    return MadeSurface(
        surface=design.only(site, position=place.position[order], height=height, radius=radii),
        design=design,
        site=site,
        height_sd=np.sqrt(variance[:, 2] + level.base_sd(x, y) ** 2),
        radius_sd=np.sqrt(variance[:, 3]),
        position_sd=np.sqrt(variance[:, :2].mean(axis=1)),
        levelling=level,
        missing=missing.astype(np.int64),
        roughness=float(np.sqrt(np.mean([cap.sd**2 for cap in caps]))),
        rotation=place.rotation,
        mirrored=place.mirrored,
        on_map=value[order, :2],
        notes=tuple(notes),
    )


def _spheres(
    picture: HeightMap, design: Surface, bow: bool, mould: bool
) -> tuple[Levelling, list[Cap], FloatArray, list[tuple[float, float]]]:
    """Return the base plane, the fitted caps, their covariance, and the centres of other hills [mm]."""
    lowest = _lowest(design)
    foot = math.sqrt(lowest * (2.0 * float(design.radius.min()) - lowest))
    side = max(1, int(2.0 * foot / ACROSS / max(picture.pixel)))
    if min(picture.values.shape) < FEWEST * side:
        side = max(1, min(picture.values.shape) // FEWEST)
    found = cells(picture, side)
    radius = float(np.median(design.radius))
    on_hills, starts, other = hills(found, levelled(picture, found, bow), LOWEST * lowest, radius)
    level = levelled(picture, found, bow, on_hills)
    hill = "1 hill of another shape" if len(other) == 1 else f"{len(other)} hills of other shapes"
    must = f"the map shows no cap of a radius near {radius:g} mm, but {hill}; check"
    refuse_if(not starts, f"{must} pixel_size, the unit of the heights and mould={not mould}")
    return level, *fitted_caps(picture, level, starts), other


def _height_map(values: ArrayLike, pixel_size: float | tuple[float, float], mould: bool) -> HeightMap:
    """Return the checked height map, without a copy of the heights."""
    if check.scalar(pixel_size):
        width = height = check.number("pixel_size", pixel_size, above=0.0)
    else:
        width, height = check.array("pixel_size", pixel_size, shape=(2,), positive=True).tolist()
    try:
        array: NDArray[np.floating] = (
            np.ma.filled(values, np.nan) if np.ma.isMaskedArray(values) else np.asarray(values)
        )
        if array.dtype not in (np.float32, np.float64):
            array = array.astype(np.float64)
    except (TypeError, ValueError):
        raise InvalidInput("height_map is not an array of numbers") from None
    wrong = array.ndim != 2 or min(array.shape) < FEWEST
    must = f"it must have shape (rows, columns), each at least {FEWEST}"
    refuse_if(wrong, f"the map has shape {array.shape}; {must}")
    return HeightMap(array, (width, height), -1.0 if mould else 1.0)


def _lowest(design: Surface) -> float:
    """Return the smallest height of a measurable cap [mm]."""
    measurable = design.height > FLATTEST * design.radius
    refuse_if(not measurable.any(), f"design_surface has no summit above {FLATTEST:g} of its radius")
    return float(min(design.height[measurable].min(), design.radius.min()))
