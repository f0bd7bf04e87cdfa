"""Sums over scattered positions: near pairs are summed directly, the smooth remainder on a grid.

Ewald's splitting is ``1/r = erfc(r/s)/r + erf(r/s)/r``. The first part decays within a few s and is summed
over pairs. The second part and the regular part of the substrate contain only waves that the grid resolves.
The sources are spread to the grid by a smooth window. Their Fourier transform is multiplied by the transform
of the field, and the result is interpolated from the grid.
"""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.fft import irfft2, next_fast_len, rfft2
from scipy.sparse import csr_array
from scipy.special import erf, erfc

from metafem._kernels import mesh
from metafem._kernels.mesh import POINTS, SHAPE
from metafem._validate import FloatArray
from metafem.models._resources import THREADS
from metafem.substrate import Radial

# Largest distance of near pairs over s; there erfc = 3e-11.
REACH = 4.7

# Grid step over s. The Fourier components of the field decrease as exp(-(k s/2)^2). At four steps per
# wavelength, the limit for which the window is accurate, they are 4e-11 of the longest component.
STEP = 0.16

# Largest distance of near pairs, divided by the mean spacing of the positions. With this value pairs and grid
# take about the same time.
PAIRS = 9.0

# Number of grid steps beyond the scene within which the distance along each axis becomes constant, so that
# the field on the periodic grid is smooth. The slope of the distance follows an error function with 1/12 of
# these steps as its width. At both ends the remaining jump is 1e-17. At the end of the band, the Fourier
# components are 1e-12.
MARGIN = 80
WIDTHS = 12.0

# Minimum number of grid steps per layer thickness t. The Fourier components of a layer's regular part
# decrease as k t exp(-2 k t), to 1e-12 at the end of the band.
LAYER_STEPS = 10.0

# Distance, in layer thicknesses, beyond which the influence of a bonded layer is below 2e-11 of the influence
# of a half-space for any Poisson's ratio. On thin layers only the pairs within this distance are summed.
LAYER_REACH = 35.0

# Only pairs are summed if the distance above is at most this multiple of the largest distance of near pairs.
# A grid that is fine enough for such a thin layer would take more time.
FARTHEST = 2.0

# Number of rows that are summed exactly to check the sums.
SAMPLE = 64


class ScatteredSums:
    """Products with the influence matrix and its derivatives, for any positions, by Ewald's method."""

    def __init__(self, position: FloatArray, substrate: Radial) -> None:
        self.substrate = substrate
        self.products = 0
        low = position.min(axis=0)
        extent = position.max(axis=0) - low
        spacing = math.sqrt(float(np.prod(np.maximum(extent, extent.max() / len(position)))) / len(position))
        self.reach = PAIRS * spacing
        self.split = self.reach / REACH
        self.step = STEP * self.split
        self._spacing = spacing
        self._pairs_alone = False
        thickness = getattr(substrate, "thickness", None)
        if thickness is not None:
            layer_reach = LAYER_REACH * thickness
            self._pairs_alone = layer_reach <= FARTHEST * self.reach
            self.reach = layer_reach if self._pairs_alone else self.reach
            self.step = min(self.step, thickness / LAYER_STEPS)
        self._grid_position = np.ascontiguousarray((position - low)[:, ::-1]) / self.step + 0.5 * POINTS + 1.0
        self._span = np.ceil(extent[::-1] / self.step) + POINTS + 3.0
        self._position = position

    @property
    def note(self) -> str:
        """Text of the note that describes the sums."""
        if self._pairs_alone:
            return (
                f"{len(self._position)} scattered positions: pairs beyond {self.reach:.3g} mm were left out, "
                "where the layer is below 2e-11 of a half-space"
            )
        return (
            f"{len(self._position)} scattered positions: pairs nearer than {self.reach:.3g} mm were summed "
            f"directly, the rest on a grid; {SAMPLE} rows were checked exactly"
        )

    @property
    def pairs(self) -> float:
        """Approximate number of near pairs."""
        return 0.5 * math.pi * (self.reach / self._spacing) ** 2 * len(self._position)

    @property
    def cells(self) -> int:
        """Number of cells of the padded grid."""
        return 0 if self._pairs_alone else math.prod(self._padded)

    def error(self, load: FloatArray) -> float:
        """Return the largest error [mm] of G p at a sample of the loaded positions."""
        loaded = np.flatnonzero(load)
        rows = loaded[:: max(1, len(loaded) // SAMPLE)]
        worst, fast = 0.0, self.displacement(load)
        for i in rows:
            r = np.hypot(*(self._position[i] - self._position).T)
            r[i] = math.inf
            near = np.where(np.isfinite(r), r, 1.0)
            value = np.where(np.isfinite(r), self.substrate.influence(near), 0.0)
            worst = max(worst, abs(float(value @ load) - float(fast[i])))
        return worst

    def displacement(
        self, load: FloatArray, size: FloatArray | None = None, *moment: FloatArray
    ) -> FloatArray:
        """Return G p, (n,) [mm]; with sizes v and moments w of the sources, return G p + lap v + grad . w.

        load: p; size: v; moment: the two components of w. lap and grad are derivatives of G at the source.
        """
        near = self._near[0]
        result = near @ load + near.T @ load - self._self_terms[0] * load
        sources, spectra = [load], [self._influence]
        if size is not None:
            # the derivative at the source is the opposite of that at the displaced end
            sources, spectra = [load, size, *moment], [self._influence, *self._derivatives]
            laplacian, x, y = self._near_derivatives
            result += laplacian @ size + laplacian.T @ size - self._self_terms[1] * size
            result += x.T @ moment[0] - x @ moment[0] + y.T @ moment[1] - y @ moment[1]
        self.products += len(sources)
        if not self._pairs_alone:
            total = self._forward(load) * self._influence
            for source, spectrum in zip(sources[1:], spectra[1:], strict=True):
                total += self._forward(source) * spectrum
            result += self._backward(total)
        return np.asarray(result)

    def field(self, load: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the Laplacian and the two slopes of G p at the asperities, (n,) each."""
        near, x, y = self._near_derivatives
        laplacian = near @ load + near.T @ load - self._self_terms[1] * load
        slope_x, slope_y = x @ load - x.T @ load, y @ load - y.T @ load
        self.products += 1
        if not self._pairs_alone:
            load_hat = self._forward(load)
            smooth, smooth_x, smooth_y = (self._backward(load_hat * s) for s in self._derivatives)
            return laplacian + smooth, slope_x - smooth_x, slope_y - smooth_y
        return laplacian, slope_x, slope_y

    @cached_property
    def _self_terms(self) -> tuple[float, float]:
        """Smooth parts of G and its Laplacian at the source, to be subtracted; self_curvature is retained."""
        if self._pairs_alone:
            return 0.0, -2.0 * self.substrate.self_curvature
        constant = 2.0 / (self.split * math.pi**1.5) + self.substrate.self_influence
        return constant, -8.0 / (3.0 * math.pi**1.5 * self.split**3)

    @cached_property
    def _pairs(self) -> tuple[NDArray[np.int64], NDArray[np.int64], FloatArray, FloatArray]:
        """Indices i and j of the near pairs, and x_i - x_j and y_i - y_j [mm]."""
        i, j = scipy.spatial.cKDTree(self._position).query_pairs(self.reach, output_type="ndarray").T
        dx, dy = (self._position[i] - self._position[j]).T
        return i, j, dx, dy

    def _matrix(self, value: FloatArray) -> Any:
        i, j, _, _ = self._pairs
        shape = (len(self._position), len(self._position))
        return csr_array((value, (i.astype(np.int32), j.astype(np.int32))), shape=shape)

    @cached_property
    def _near(self) -> tuple[Any]:
        _, _, dx, dy = self._pairs
        r = np.hypot(dx, dy)
        if self._pairs_alone:
            return (self._matrix(self.substrate.influence(r)),)
        return (self._matrix(erfc(r / self.split) / (math.pi * r)),)

    @cached_property
    def _near_derivatives(self) -> tuple[Any, Any, Any]:
        """Matrices of the near part's Laplacian and of its slopes along x and y at i."""
        _, _, dx, dy = self._pairs
        r, s = np.hypot(dx, dy), self.split
        if self._pairs_alone:
            _, first, second = self.substrate.influence(r, derivatives=True)
            first /= r
            return self._matrix(second + first), self._matrix(first * dx), self._matrix(first * dy)
        point = erfc(r / s) / (math.pi * r)
        bell = 2.0 / (s * math.pi**1.5) * np.exp(-((r / s) ** 2)) / r
        first = -point / r - bell  # d/dr of erfc(r/s)/(pi r)
        second = 2.0 * point / r**2 + 2.0 * bell / r + 2.0 * r * bell / s**2
        first /= r
        return self._matrix(second + first), self._matrix(first * dx), self._matrix(first * dy)

    @cached_property
    def _padded(self) -> tuple[int, ...]:
        return tuple(next_fast_len(2 * int(span + MARGIN), real=True) for span in self._span)

    @cached_property
    def _waves(self) -> tuple[FloatArray, FloatArray]:
        """Wavenumbers along rows and columns [1/step]."""
        rows, columns = self._padded
        full, half = np.fft.fftfreq(rows), np.fft.rfftfreq(columns)
        return np.asarray(2.0 * math.pi * full[:, None]), np.asarray(2.0 * math.pi * half)

    @cached_property
    def _influence(self) -> FloatArray:
        """Transform of the smooth field, divided by the square of the window's transform."""
        if self._pairs_alone:
            return np.empty((0, 0))
        axes = [self._bent(size, span) for size, span in zip(self._padded, self._span, strict=True)]
        r = np.hypot(axes[0][:, None], axes[1])
        with np.errstate(invalid="ignore"):
            point = np.where(r > 0.0, erf(r / self.split) / (math.pi * r), 2.0 / (self.split * math.pi**1.5))
        spectrum = np.asarray(rfft2(point + self.substrate.regular(r), workers=THREADS).real)
        for k in self._waves:
            spectrum *= np.where(np.abs(k) <= 0.5 * math.pi, 1.0 / _window_transform(k) ** 2, 0.0)
        return spectrum

    @cached_property
    def _derivatives(self) -> tuple[NDArray[Any], ...]:
        """Transforms of the smooth field's Laplacian and of its derivatives at the source along x and y."""
        if self._pairs_alone:
            return (np.empty((0, 0)),) * 3
        ky, kx = (k / self.step for k in self._waves)
        influence = self._influence
        return -(kx**2 + ky**2) * influence, -1j * kx * influence, -1j * ky * influence

    def _bent(self, size: int, span: float) -> FloatArray:
        """Return distances along a cyclic axis [mm], exact up to `span` steps, then smoothly constant."""
        x = np.abs(np.fft.fftfreq(size, 1.0 / size))
        width = MARGIN / WIDTHS
        y = (x - span - 0.5 * MARGIN) / width
        # integral of erfc((x - middle)/width)/2 from 0: x itself far below the middle
        bent = 0.5 * width * (y * erfc(y) - np.exp(-(y**2)) / math.sqrt(math.pi)) + span + 0.5 * MARGIN
        return np.asarray(self.step * np.where(x <= span, x, bent))

    def _forward(self, vector: FloatArray) -> NDArray[np.complex128]:
        grid = np.zeros(self._padded)
        mesh.spread(self._grid_position, np.ascontiguousarray(vector), grid)
        return np.asarray(rfft2(grid, workers=THREADS, overwrite_x=True))

    def _backward(self, spectrum: NDArray[np.complex128]) -> FloatArray:
        result = np.empty(len(self._position))
        mesh.gather(self._grid_position, irfft2(spectrum, self._padded, workers=THREADS), result)
        return result


def _window_transform(wavenumber: FloatArray) -> FloatArray:
    """Return the Fourier transform of the window at wavenumbers [1/step]."""
    node, weight = np.polynomial.legendre.leggauss(60)
    x = 0.25 * POINTS * (node + 1.0)
    value = np.exp(SHAPE * (np.sqrt(1.0 - (2.0 * x / POINTS) ** 2) - 1.0))
    return np.asarray(np.cos(wavenumber[..., None] * x) @ (0.5 * POINTS * weight * value))
