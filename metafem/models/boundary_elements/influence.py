"""Products with the influence matrix of all cells, without storing this matrix, and a preconditioner."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy import fft

from metafem._kernels import love
from metafem._validate import FloatArray
from metafem.models._convolution import convolve
from metafem.models._resources import THREADS
from metafem.models.boundary_elements.far_field import FarField
from metafem.models.boundary_elements.patches import Patch

# Number of aliases on each side in the symbol of the preconditioner; their terms decrease as the cube of the
# index.
ALIASES = 3

# Gauss points, two per side, for the mean over a cell of a function that is smooth on the scale of a cell.
GAUSS_POINTS = [
    (x, y) for x in (-math.sqrt(1 / 12), math.sqrt(1 / 12)) for y in (-math.sqrt(1 / 12), math.sqrt(1 / 12))
]


class Influence:
    """Displacement [cells] of every cell by the pressures p/E* on all cells.

    Within a patch, Love's solution and the substrate's regular part are convolved with the pressure by FFT.
    The padding to twice the patch makes this exact. Between patches, expansions are used. Vectors contain the
    cells of all patches, one patch after the other.
    """

    def __init__(
        self,
        patches: list[Patch],
        influence: Callable[[FloatArray], FloatArray],
        regular: Callable[[FloatArray], FloatArray],
    ) -> None:
        shapes = [p.shape for p in patches]
        rows, columns = (max(s[k] for s in shapes) for k in range(2))
        i, j = np.arange(rows)[:, None], np.arange(columns)[None, :]
        near = love.table(rows, columns)
        for x, y in GAUSS_POINTS:
            near += 0.25 * regular(np.hypot(i + x, j + y))
        self.shapes = shapes
        self.edges = np.concatenate([[0], np.cumsum([a * b for a, b in shapes])])
        self.spectra = {s: _spectrum(near[: s[0], : s[1]]) for s in set(shapes)}
        self.symbols = {s: _symbol(_fast(s)) for s in set(shapes)}
        self.far = FarField(influence, np.array([p.centre for p in patches]), shapes)
        self.products = 0

    @property
    def size(self) -> int:
        """Number of cells."""
        return int(self.edges[-1])

    def split(self, vector: FloatArray) -> list[FloatArray]:
        """Return views of a vector's part for each patch, in the shape of the patch."""
        return [
            vector[a:b].reshape(s)
            for a, b, s in zip(self.edges[:-1], self.edges[1:], self.shapes, strict=True)
        ]

    def product(self, pressure: FloatArray) -> FloatArray:
        """Return the displacement of every cell [cells] by pressures p/E*."""
        self.products += 1
        result = np.empty_like(pressure)
        sources, targets = self.split(pressure), self.split(result)
        for source, target in zip(sources, targets, strict=True):
            spectrum = self.spectra[source.shape]

            def parts(block: slice, spectrum: FloatArray = spectrum) -> list[list[FloatArray]]:
                return [[spectrum[:, block]]]

            waves = spectrum.shape[1]
            (target[...],) = convolve([source], parts, _padded(source.shape), waves, THREADS)
        if len(sources) > 1:
            moments = np.stack([self.far.moments(source) for source in sources])
            for target, local in zip(targets, self.far.local(moments), strict=True):
                target += self.far.displacement(local, target.shape)
        return result

    def precondition(self, vector: FloatArray) -> FloatArray:
        """Return an approximate solution on each patch: the inverse symbol of the half-space is applied."""
        result = np.empty_like(vector)
        for source, target in zip(self.split(vector), self.split(result), strict=True):
            rows, columns = source.shape
            size = _fast(source.shape)
            wave = fft.rfft2(source, s=size, workers=THREADS) * self.symbols[source.shape]
            target[...] = fft.irfft2(wave, s=size, overwrite_x=True, workers=THREADS)[:rows, :columns]
        return result


def _fast(shape: tuple[int, int]) -> tuple[int, int]:
    """Return sizes for a fast transform, at least as large as the shape."""
    return fft.next_fast_len(shape[0]), fft.next_fast_len(shape[1], real=True)


def _padded(shape: tuple[int, int]) -> tuple[int, int]:
    """Return padded sizes for which the wrap-around of a convolution does not affect the result."""
    return _fast((2 * shape[0] - 1, 2 * shape[1] - 1))


def _spectrum(quadrant: FloatArray) -> FloatArray:
    """Return the real transform of the even extension of a quadrant of influences."""
    n0, n1 = quadrant.shape
    m0, m1 = _padded((n0, n1))
    full = np.zeros((m0, m1))
    full[:n0, :n1] = quadrant
    full[m0 - n0 + 1 :, :n1] = quadrant[:0:-1]
    full[:, m1 - n1 + 1 :] = full[:, n1 - 1 : 0 : -1]
    return np.ascontiguousarray(fft.rfft2(full).real)


def _symbol(shape: tuple[int, int]) -> FloatArray:
    """Return the inverse symbol of Love's solution on a periodic grid, ``|k|/2`` for long waves.

    The symbol is the product of 2/|k|, the symbol of the half-space, and the symbol of the cell, summed over
    the aliases. The mean, k = 0, is treated as a wave of twice the patch length, which suffices for a
    preconditioner.
    """
    k0 = 2.0 * math.pi * np.fft.fftfreq(shape[0])[:, None]
    k1 = 2.0 * math.pi * np.fft.rfftfreq(shape[1])[None, :]
    k1[0, 0] = math.pi / max(shape)
    total = np.zeros(np.broadcast_shapes(k0.shape, k1.shape))
    for a in range(-ALIASES, ALIASES + 1):
        for b in range(-ALIASES, ALIASES + 1):
            x, y = k0 + 2.0 * math.pi * a, k1 + 2.0 * math.pi * b
            total += np.sinc(0.5 * x / math.pi) * np.sinc(0.5 * y / math.pi) * 2.0 / np.hypot(x, y)
    return np.asarray(1.0 / total)
