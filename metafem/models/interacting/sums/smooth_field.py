"""Smooth fields of scattered sources, computed on a grid.

The sources are spread to the grid by a smooth window. Their Fourier transform is multiplied by that of the
field, and the result is interpolated from the grid by the same window, ``w(x) = exp(b (sqrt(1 - x^2) - 1))``
for |x| < 1. Beyond the wavenumber b its transform is about exp(-b) (Barnett, Magland and af Klinteberg, SIAM
J. Sci. Comput. 41, C479 (2019), doi:10.1137/18M120885X).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dctn, next_fast_len
from scipy.special import erfc

from metafem._kernels.sums import mesh
from metafem._validate import FloatArray
from metafem.models._convolution import convolve
from metafem.models._resources import THREADS, run_rows

# Largest wavenumber of the field, divided by that of the grid, pi per step. The window is accurate for it,
# since the longer waves, whose errors matter most, are farther from their images.
BAND = 0.7

# Number of grid steps beyond the scene within which the distance along each axis becomes constant, so that
# the field on the periodic grid is smooth. The slope of the distance follows an error function with 1/12 of
# these steps as its width. At both ends the remaining jump is 1e-17. At the end of the band, the Fourier
# components are 1e-12.
MARGIN = 80
WIDTHS = 12.0

# Number of positions above which a second thread saves time: about a millisecond.
POSITIONS_PER_THREAD = 1000

# Degree of the polynomials that represent the window between two grid points, minus its number of points.
MORE = 2


@dataclass(frozen=True)
class SmoothField:
    """The smooth part of an influence between positions, on a grid."""

    position: FloatArray  # row and column of the sources and targets [mm], from 0, (n, 2)
    step: float  # of the grid [mm]
    far: float  # distance beyond which the influence is neglected [mm]
    points: int  # number of grid points of the window
    shape: float  # b of the window
    real: Any  # type of the numbers on the grid
    fill: Callable[[FloatArray, FloatArray], FloatArray]  # returns the influence at distances (y, x) [mm]

    def add(
        self,
        sources: list[FloatArray],
        terms: list[list[int]],
        total: FloatArray,
    ) -> None:
        """Add the fields of the sources (n,) to `total` (m, n).

        terms: for each result and source, the index of its field in `_transforms`.
        """
        grids = [np.zeros(self._span, dtype=self.real) for _ in sources]
        for source, grid in zip(sources, grids, strict=True):
            mesh.spread(self._grid_position, self._table, source, grid)

        def spectra(block: slice) -> list[list[NDArray[Any]]]:
            found = self._transforms(block, alone=terms == [[0]])
            return [[found[term] for term in line] for line in terms]

        fields = convolve(grids, spectra, self.padded, self._kept, THREADS)
        for field, part in zip(fields, total, strict=True):

            def run(rows: slice, field: NDArray[Any] = field, part: FloatArray = part) -> None:
                mesh.gather(self._grid_position, self._table, field, rows.start, rows.stop, part)

            run_rows(run, len(self.position), len(self.position), POSITIONS_PER_THREAD)

    @cached_property
    def _grid_position(self) -> FloatArray:
        return np.asarray(self.position / self.step + 0.5 * self.points + 1.0)

    @cached_property
    def _span(self) -> NDArray[np.int64]:
        """Number of rows and columns of the grid that contain the sources."""
        return np.asarray(np.ceil(self._grid_position.max(axis=0) + 0.5 * self.points + 1.0), dtype=np.int64)

    @cached_property
    def _table(self) -> FloatArray:
        return window_table(self.points, self.shape)

    @cached_property
    def _half(self) -> list[int]:
        """Half of the numbers of rows and columns of the padded grid."""
        far = self.far / self.step
        return [
            next_fast_len(math.ceil(min(span + MARGIN, 0.5 * (max(span, far) + far))), real=True)
            for span in self._span
        ]

    @property
    def padded(self) -> tuple[int, int]:
        """Numbers of rows and columns of the padded grid."""
        rows, columns = self._half
        return 2 * rows, 2 * columns

    @property
    def _kept(self) -> int:
        """Number of wavenumbers along the rows within the band."""
        return int(BAND * self._half[1]) + 1

    @cached_property
    def _waves(self) -> tuple[FloatArray, FloatArray]:
        """Wavenumbers along rows and columns within the band [1/step]."""
        rows, columns = self.padded
        along = 2.0 * math.pi * np.fft.rfftfreq(columns)[: self._kept]
        return np.asarray(2.0 * math.pi * np.fft.fftfreq(rows)), np.asarray(along)

    @cached_property
    def _influence(self) -> NDArray[Any]:
        """Transform of the smooth field within the band, divided by the square of the window's transform.

        The rows are those of the wavenumbers from 0 on; the field is even along both axes.
        """
        axes = [self._bent(half, span) for half, span in zip(self._half, self._span, strict=True)]
        field = self.fill(*axes)
        spectrum = dctn(field, type=1, overwrite_x=True, workers=THREADS)[:, : self._kept]
        rows = np.abs(self._waves[0][: len(spectrum)])
        spectrum *= np.where(rows <= BAND * math.pi, 1.0, 0.0)[:, None]
        for k in (rows[:, None], self._waves[1]):
            spectrum /= window_transform(k, self.points, self.shape) ** 2
        return np.asarray(spectrum, dtype=self.real)

    def _transforms(self, block: slice, alone: bool) -> list[NDArray[Any]]:
        """Return the transforms of the field, its Laplacian, and its derivatives by y and x at the source.

        block: of wavenumbers along x; alone: whether only the first is needed.
        """
        half = self._influence[:, block]
        influence = np.concatenate([half, half[-2:0:-1]])
        if alone:
            return [influence]
        real = self.real
        ky, kx = ((k / self.step).astype(real) for k in (self._waves[0][:, None], self._waves[1][block]))
        minus = np.array(-1j, dtype=np.result_type(real, np.complex64))
        return [influence, -(kx**2 + ky**2) * influence, minus * ky * influence, minus * kx * influence]

    def _bent(self, half: int, span: int) -> FloatArray:
        """Return distances along half of a cyclic axis [mm], exact up to `span` steps, then constant.

        They are exact to the end if the influence vanishes before.
        """
        x = np.arange(half + 1.0)
        if half < span + MARGIN:
            return np.asarray(self.step * x)
        width = MARGIN / WIDTHS
        y = (x - span - 0.5 * MARGIN) / width
        # integral of erfc((x - middle)/width)/2 from 0: x itself far below the middle
        bent = 0.5 * width * (y * erfc(y) - np.exp(-(y**2)) / math.sqrt(math.pi)) + span + 0.5 * MARGIN
        return np.asarray(self.step * np.where(x <= span, x, bent))


def window(x: FloatArray, shape: float) -> FloatArray:
    """Return the window at x [-], from -1 to 1."""
    return np.asarray(np.exp(shape * (np.sqrt(np.maximum(1.0 - x**2, 0.0)) - 1.0)))


def window_table(points: int, shape: float) -> FloatArray:
    """Return the table of `metafem._kernels.sums.mesh` for a window over a number of grid points."""
    degree = points + MORE
    node = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    # the first of the points is from 0 to 1 step inside the window's edge
    x = 2.0 / points * (np.arange(points) + 0.5 * (node[:, None] + 1.0)) - 1.0
    return np.ascontiguousarray(np.linalg.solve(np.vander(node, increasing=True), window(x, shape)))


def window_transform(wavenumber: FloatArray, points: int, shape: float) -> FloatArray:
    """Return the Fourier transform of the window over a number of points at wavenumbers [1/step]."""
    node, weight = quadrature()
    x = 0.5 * points * node
    return np.asarray(np.cos(wavenumber[..., None] * x) @ (points * weight * window(node, shape)))


@cache
def quadrature() -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights of a quadrature from 0 to 1."""
    node, weight = np.polynomial.legendre.leggauss(80)
    return 0.5 * (node + 1.0), 0.5 * weight
