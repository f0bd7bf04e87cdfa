"""Products with the influence of all cells of a periodic surface, by cyclic Fourier transforms.

The grid covers one period, so the transforms need no padding. The influence of a cell on itself and its
neighbours is Love's solution; with the lattice sum S of point loads at distances r, all in cells, it is

    K(x) = S + lap S/24 + [Love(x) - 1/(pi r) - 1/(24 pi r^3)]

since Love's far field is ``G + lap G/24`` up to the fourth order, so that the bracket decreases as r^-5.
Only cells near contacts carry pressure; their patches share the grid of the period.
"""

from __future__ import annotations

import math

import numpy as np
from scipy import fft

from metafem._kernels import love
from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.material import PeriodicCell
from metafem.models._resources import THREADS
from metafem.models.boundary_elements.far_field import SingleArray, Vector
from metafem.models.boundary_elements.influence import Influence
from metafem.models.boundary_elements.patches import Patch
from metafem.substrate import Radial
from metafem.surface import Surface

# Distance [cells] up to which Love's solution replaces its far field; the difference there is below 1e-12.
NEAR = 64

# Deviation of the numbers of cells in a period from whole numbers.
WHOLE = 1e-9


def fitting_side(cell: float, period: PeriodicCell) -> tuple[float, tuple[int, int]]:
    """Return the largest side of square cells, up to `cell` [mm], that divide a period, and their numbers."""
    fewest = math.ceil(period.width / cell * (1.0 - WHOLE))
    for along_x in range(fewest, 2 * fewest + 1):
        along_y = along_x * period.length / period.width
        if abs(along_y - round(along_y)) <= WHOLE * along_y:
            return period.width / along_x, (along_x, round(along_y))
    raise InvalidInput(
        f"no square cells of {0.5 * cell:.3g} to {cell:.3g} mm divide both sides of the periodic cell, "
        f"{period.width:g} and {period.length:g} mm; use sides with a simpler ratio"
    )


def framed(surface: Surface) -> Surface:
    """Return the surface with its sites moved by whole periods, so that the widest gaps are at the border."""
    if surface.cell is None:
        return surface
    columns = []
    for place, side in zip(surface.position.T, (surface.cell.width, surface.cell.length), strict=True):
        inside = np.mod(place - place.min(), side)
        ordered = np.sort(inside)
        gaps = np.diff(ordered, append=ordered[0] + side)
        start = ordered[(int(gaps.argmax()) + 1) % len(ordered)]
        columns.append(np.where(inside < start, inside + side, inside) + place.min())
    return surface.replaced(position=np.stack(columns, axis=1))


def spectrum(substrate: Radial, period: PeriodicCell, cell: float, shape: tuple[int, int]) -> FloatArray:
    """Return the real transform of the influence [cells] between the cells of one period."""
    i, j = (np.arange(n // 2 + 1.0) for n in shape)
    x, y = np.meshgrid(cell * i, cell * j, indexing="ij")
    point = substrate.periodic(period, x, y)
    quadrant = cell * (point.value + cell**2 / 24.0 * point.laplacian)
    rows, columns = (min(NEAR, n.size) for n in (i, j))
    r = np.hypot(i[:rows, None], j[:columns])
    r[0, 0] = np.inf
    near = love.table(rows, columns) - (1.0 / r + 1.0 / (24.0 * r**3)) / math.pi
    quadrant[:rows, :columns] += near
    mirror = np.ix_(*(np.minimum(np.arange(n), n - np.arange(n)) for n in shape))
    result = np.ascontiguousarray(fft.rfft2(quadrant[mirror], workers=THREADS).real)
    # the mean over a cell has no aliases at q = 0
    result[0, 0] = substrate.transform(np.zeros(1))[0] / cell
    return result


class PeriodicInfluence(Influence):
    """Displacement [cells] of the cells of all patches by pressures p/E* on them and on all their periods."""

    def __init__(self, patches: list[Patch], shape: tuple[int, int], transform: FloatArray) -> None:
        self.shapes = [p.shape for p in patches]
        self.edges = np.concatenate([[0], np.cumsum([a * b for a, b in self.shapes])])
        places = []
        for p in patches:
            rows, columns = (
                np.mod(first + np.arange(count), size)
                for first, count, size in zip(p.corner, p.shape, shape, strict=True)
            )
            places.append((rows[:, None] * shape[1] + columns).ravel())
        self.place = np.concatenate(places)
        if np.unique(self.place).size < self.place.size:
            raise InvalidInput(
                "contacts of adjacent periods nearly touch: the cells around them overlap; use lighter "
                "loads, a larger periodic cell, or metafem.Interacting()"
            )
        self.grid = shape
        inverse = transform.copy()
        inverse[0, 0] = 2.0 * max(inverse[0, 1], inverse[1, 0])  # any positive value preconditions the mean
        self.transforms = {
            np.dtype(t): tuple(part.astype(t, copy=False) for part in (transform, 1.0 / inverse))
            for t in (np.float64, np.float32)
        }
        self.products = 0

    def product(self, pressure: Vector) -> Vector:
        """Return the displacement of every cell [cells] by pressures p/E*, in the precision of these."""
        self.products += 1
        return self._filtered(pressure, 0)

    def precondition(self, vector: SingleArray) -> SingleArray:
        """Return an approximate solution: the inverse influence of the full grid is applied."""
        return self._filtered(vector, 1)

    def _filtered(self, vector: Vector, which: int) -> Vector:
        """Return the cyclic convolution with the influence (0) or its inverse (1), on the patches."""
        grid = np.zeros(self.grid, dtype=vector.dtype)
        grid.ravel()[self.place] = vector
        wave = fft.rfft2(grid, workers=THREADS)
        wave *= self.transforms[vector.dtype][which]
        result: Vector = fft.irfft2(wave, s=self.grid, overwrite_x=True, workers=THREADS).ravel()[self.place]
        return result
