"""What a height map shows beside its base plane and its caps, for pictures."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.calibration.topography.cells import HeightMap, cells
from metafem.calibration.topography.made_surface import MadeSurface

# Most cells of the picture along one axis; their means show what the roughness of single pixels hides.
MOST = 300


@dataclass(frozen=True, eq=False)
class Residuals:
    """Heights minus base plane and spheres (rows, columns) [mm], and width and height of the map [mm]."""

    values: FloatArray
    width: float
    height: float


def residuals(
    values: NDArray[np.floating], pixel: tuple[float, float], made: MadeSurface, mould: bool = False
) -> Residuals:
    """Return the mean residuals in square cells of the map on which a made surface was measured.

    Base plane and spheres are subtracted from each pixel: over a cell of the side s, the mean of a sphere is
    s^2 / (12 R) lower than its height in the middle.
    """
    height_map = HeightMap(values, pixel, -1.0 if mould else 1.0)
    found = cells(height_map, math.ceil(max(values.shape) / MOST), partial(_expected, height_map, made))
    return Residuals(found.mean, pixel[0] * values.shape[1], pixel[1] * values.shape[0])


def _expected(height_map: HeightMap, made: MadeSurface, rows: slice, columns: slice) -> FloatArray:
    """Return base plane and spheres on the pixels in rows and columns, which start at column 0."""
    x, y = height_map.x(columns), height_map.y(rows)
    result = made.levelling.base(x[None, :], y[:, None])
    for centre, height, radius in zip(
        made.on_map, made.surface.height.tolist(), made.surface.radius.tolist(), strict=True
    ):
        foot = math.sqrt(max(height * (2.0 * radius - height), 0.0))
        row, column = height_map.window(centre, foot + max(height_map.pixel))
        row = slice(max(row.start - rows.start, 0), max(row.stop - rows.start, 0))
        square = (x[column] - centre[0]) ** 2 + (y[row, None] - centre[1]) ** 2
        under = np.maximum(radius**2 - square, (radius - height) ** 2)
        result[row, column] += np.sqrt(under) - (radius - height)
    return result
