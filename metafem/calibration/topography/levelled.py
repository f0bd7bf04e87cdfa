"""Fit of the base plane of a height map, with tilt and bow, between the asperities."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem._values import Value
from metafem.calibration.topography.cells import Cells, HeightMap
from metafem.calibration.topography.correlation import correlation, summed
from metafem.errors import refuse_if

# Ratio of the standard deviation of a normal variable to the median of its absolute value.
SD_OF_MEDIAN = 1.4826

# Distance from the base plane or from a sphere beyond which a value is an outlier, in standard deviations.
# For a normal variable, one value in 150,000 is farther away.
OUTLIER = 4.5

# Largest number of reweighting steps. If 40 % of the cells are on caps, 15 steps suffice.
STEPS = 50

# Smallest number of cells for the base plane, five for each of six unknowns.
FEWEST = 30

# Powers of x and y of a plane, and of a plane with bow.
PLANE = ((0, 0), (1, 0), (0, 1))
BOWED = (*PLANE, (2, 0), (1, 1), (0, 2))


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
    cell : float
        Side of a cell [mm].
    excluded : float
        Fraction of the cells that are on caps or outliers [-].
    covariance : ndarray
        Covariance of the coefficients of the powers of (x, y) / extent [mm^2].
    """

    centre: FloatArray
    extent: float
    tilt: FloatArray
    bow: FloatArray
    offset: float
    sd: float
    cell: float
    excluded: float
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
    few = int(known.sum()) < FEWEST
    empty = few and not np.isfinite(height_map.values).any()
    refuse_if(empty, "the map holds no heights: none of its pixels was measured")
    refuse_if(
        few,
        f"the map shows {int(known.sum())} cells of {found.size:.3g} mm between its summits; at least "
        f"{FEWEST} are needed for the base plane",
    )
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
    refuse_if(inside.sum() < FEWEST, f"the map holds no base plane: {lie}")
    grids = np.zeros((count + 2, *found.mean.shape))
    grids[:, known] = np.vstack([matrix * inside, np.where(inside, residual, 0.0), inside])
    columns, errors, weights = grids[:count], grids[count], grids[count + 1]
    bread = np.linalg.inv(np.einsum("kij,lij->kl", columns, columns))
    variance = float((residual[inside] ** 2).mean())
    meat = summed(columns, correlation([errors], [weights], count)) * variance
    scale = extent ** -np.array([sum(power) for power in BOWED[:count]], dtype=float)
    coefficient = np.zeros(6)
    coefficient[:count] = fit * scale
    return Levelling(
        centre, extent, coefficient[1:3], coefficient[3:], float(coefficient[0]), sd, found.size,
        1.0 - float(inside.sum()) / float(np.isfinite(found.mean).sum()), bread @ meat @ bread,
    )  # fmt: skip


def _powers(u: FloatArray, v: FloatArray, bowed: bool) -> FloatArray:
    return np.array([u**i * v**j for i, j in (BOWED if bowed else PLANE)])
