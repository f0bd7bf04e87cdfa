"""What a height map shows beside its base plane and its caps, for pictures."""

from __future__ import annotations

import math
from dataclasses import dataclass

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
    """Return the mean residuals in square cells of the map on which a made surface was measured."""
    found = cells(HeightMap(values, pixel, -1.0 if mould else 1.0), math.ceil(max(values.shape) / MOST))
    x, y = found.x, found.y[:, None]
    rest = found.mean - made.levelling.base(x[None, :], y)
    for (cx, cy), height, radius in zip(
        made.on_map.tolist(), made.surface.height.tolist(), made.surface.radius.tolist(), strict=True
    ):
        foot = math.sqrt(max(height * (2.0 * radius - height), 0.0))
        column = slice(*np.searchsorted(x, (cx - foot, cx + foot)).tolist())
        row = slice(*np.searchsorted(-y[:, 0], (-cy - foot, -cy + foot)).tolist())
        square = (x[column] - cx) ** 2 + (y[row] - cy) ** 2
        under = np.maximum(radius**2 - square, (radius - height) ** 2)
        rest[row, column] -= np.sqrt(under) - (radius - height)
    return Residuals(rest, pixel[0] * values.shape[1], pixel[1] * values.shape[0])
