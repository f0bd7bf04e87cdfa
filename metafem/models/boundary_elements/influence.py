"""Products with the influence matrix of all cells, and a preconditioner; all lengths are in cells.

Unit pressure p/E* on the unit square about the origin causes at (x, y) the displacement ``1/pi`` times the
integral of ``1/r`` over the square. Love, Phil. Trans. R. Soc. A 228, 377 (1929),
doi:10.1098/rsta.1929.0009; Johnson, Contact Mechanics (1985), eq. 3.25, doi:10.1017/CBO9781139171731.

Within a patch these displacements are convolved with the pressure by FFT. Between two separate patches the
influence is smooth, and is expanded in tensor Chebyshev polynomials: ``G(|x - y|) = sum C_kl T_k(x) T_l(y)``,
where C is computed from values at Chebyshev nodes. The far field of a patch then depends only on its q^2
Chebyshev moments. With q terms per side the error is about rate^-q, where the rate is the parameter of the
Bernstein ellipse through the nearest singularity. The regular part of a layer has its singularities farther
away than 1/r, so the same order is sufficient for all substrates.

Trefethen, Approximation Theory and Approximation Practice (2020), theorem 8.2, doi:10.1137/1.9781611975949;
Fong and Darve, J. Comput. Phys. 228, 8712 (2009), doi:10.1016/j.jcp.2009.08.031.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial.chebyshev import chebvander
from scipy import fft

from metafem._validate import FloatArray, IntArray
from metafem.models._resources import THREADS

Radial = Callable[[FloatArray], FloatArray]  # a function of the distance
Shape = tuple[int, int]

# Largest estimated relative error of the influence between two patches. The estimate is conservative:
# measured errors of sums over all cells were below 3e-10.
TOLERANCE = 1e-8


def love_table(rows: int, columns: int) -> FloatArray:
    """Return the displacements by unit pressure on one cell at offsets of (i, j) cells, (rows, columns)."""
    result = _mean(lambda r: 1.0 / np.maximum(r, 1.0), rows, columns, 3)
    # The closed form is a second difference of terms of size r, whose rounding error is about r^2 units in
    # the last place. Beyond 30 cells three Gauss points per side have an error of about (4 r)^-6 < 1e-12.
    near = slice(30)
    corners = (np.arange(len(part) + 1.0) - 0.5 for part in (result[near], result.T[near]))
    u, v = np.meshgrid(*corners, indexing="ij")
    terms = u * np.arcsinh(v / np.abs(u)) + v * np.arcsinh(u / np.abs(v))
    result[near, near] = np.diff(np.diff(terms, axis=0), axis=1)
    return result / math.pi


def convergence_rate(first: IntArray, last: IntArray) -> FloatArray:
    """Return the factor by which each additional term reduces the error between boxes of cells, (m, m).

    first, last: their first and last cells, (m, 2). Along each axis of the target, the nearest singularity is
    determined by the distance to the source box: its real part along the axis, its imaginary part across it.
    """
    centre, half = 0.5 * (first + last), 0.5 * (last - first + 1)
    apart = np.abs(centre[:, None, :] - centre[None, :, :])
    along = np.maximum(apart - half[None, :, :], 0.0)
    across = np.maximum(apart - half[:, None, :] - half[None, :, :], 0.0)[:, :, ::-1]
    z = (along + 1j * across) / half[:, None, :]
    worst = np.abs(z + np.sqrt(z - 1.0) * np.sqrt(z + 1.0)).min(axis=2)
    return np.asarray(np.minimum(worst, worst.T))


def orders(rate: FloatArray) -> IntArray:
    """Return the number of terms q per side for which rate^-q is below the tolerance."""
    return np.asarray(np.ceil(math.log(1.0 / TOLERANCE) / np.log(rate)).astype(np.int64) + 1)


class Influence:
    """Displacement of every cell by the pressures p/E* on all cells of m patches.

    corner: first cells of the patches, (m, 2); shapes: their rows and columns, equal ones in a row.
    Vectors contain the cells of all patches, one patch after the other. influence, regular: displacement by
    unit pressure on one distant cell, and its part by the substrate's regular influence.
    """

    def __init__(self, corner: IntArray, shapes: Sequence[Shape], influence: Radial, regular: Radial) -> None:
        rows, columns = np.max(shapes, axis=0).tolist()
        near = love_table(rows, columns) + _mean(regular, rows, columns, 2)
        self.groups = list(dict.fromkeys(shapes))
        self.edges = np.cumsum([0, *(shapes.count(s) * s[0] * s[1] for s in self.groups)])
        self.size = int(self.edges[-1])
        self.spectra = [_spectrum(near[: s[0], : s[1]]) for s in self.groups]
        self.symbols = [_symbol(_fast(s)) for s in self.groups]
        self.blocks: list[tuple[int, IntArray, IntArray, FloatArray]] = []
        if len(shapes) == 1:
            return
        half = 0.5 * np.array(shapes)
        centre = corner + half
        first, second = np.triu_indices(len(shapes), 1)
        order = orders(convergence_rate(corner, corner + shapes - 1)[first, second])
        for q in np.unique(order).tolist():
            a, b = first[order == q], second[order == q]
            block = _coefficients(influence, centre[a] - centre[b], half[a], half[b], q)
            self.blocks.append((q, a, b, block))
        self.bases = [[_basis(n, int(order.max())) for n in s] for s in self.groups]

    def split(self, vector: FloatArray) -> list[FloatArray]:
        """Return views of a vector's parts for patches of one shape, (number, rows, columns)."""
        parts = np.split(vector, self.edges[1:-1])
        return [part.reshape(-1, *s) for part, s in zip(parts, self.groups, strict=True)]

    def product(self, pressure: FloatArray) -> FloatArray:
        """Return the displacement of every cell by pressures p/E*."""
        sources = self.split(pressure)
        parts = []
        for source, spectrum, s in zip(sources, self.spectra, self.groups, strict=True):
            rows, columns = _padded(s)
            wave = fft.rfft(source, columns, axis=2, workers=THREADS)
            wave = fft.fft(wave, rows, axis=1, overwrite_x=True, workers=THREADS)
            wave *= spectrum
            wave = fft.ifft(wave, axis=1, overwrite_x=True, workers=THREADS)[:, : s[0]]
            parts.append(fft.irfft(wave, columns, axis=2, workers=THREADS)[:, :, : s[1]])
        if self.blocks:
            moments = np.concatenate(
                [x.T @ source @ y for source, (x, y) in zip(sources, self.bases, strict=True)]
            )
            ends = np.cumsum([len(source) for source in sources])[:-1]
            for part, local, (x, y) in zip(
                parts, np.split(self._local(moments), ends), self.bases, strict=True
            ):
                part += x @ local @ y.T
        return np.concatenate([part.ravel() for part in parts])

    def _local(self, moments: FloatArray) -> FloatArray:
        """Return the coefficients of each patch's displacement by the other patches, (m, size, size)."""
        result = np.zeros_like(moments)
        for q, first, second, block in self.blocks:
            part = moments[:, :q, :q].reshape(-1, q * q)
            local = np.zeros_like(part)
            # no matrix products, whose threads may wait for busy cores
            np.add.at(local, first, np.einsum("kab,kb->ka", block, part[second]))
            np.add.at(local, second, np.einsum("kab,ka->kb", block, part[first]))
            result[:, :q, :q] += local.reshape(-1, q, q)
        return result

    def precondition(self, vector: FloatArray) -> FloatArray:
        """Return an approximate solution on each patch: the inverse symbol of the half-space is applied."""
        parts = []
        for source, symbol, s in zip(self.split(vector), self.symbols, self.groups, strict=True):
            wave = fft.rfft2(source, _fast(s), workers=THREADS) * symbol
            part = fft.irfft2(wave, _fast(s), overwrite_x=True, workers=THREADS)
            parts.append(part[:, : s[0], : s[1]].ravel())
        return np.concatenate(parts)


def _mean(function: Radial, rows: int, columns: int, points: int) -> FloatArray:
    """Return means over cells at offsets of (i, j) cells by Gauss points on each side, (rows, columns)."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    total = np.zeros((rows, columns))
    for x, a in zip(0.5 * nodes, 0.5 * weights, strict=True):
        for y, b in zip(0.5 * nodes, 0.5 * weights, strict=True):
            total += a * b * function(np.hypot(np.arange(rows)[:, None] + x, np.arange(columns) + y))
    return total


def _fast(shape: Shape) -> Shape:
    """Return sizes for a fast transform, at least as large as the shape."""
    return fft.next_fast_len(shape[0]), fft.next_fast_len(shape[1], real=True)


def _padded(shape: Shape) -> Shape:
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


def _symbol(shape: Shape) -> FloatArray:
    """Return |k|/2, the inverse symbol of the half-space on a periodic grid.

    The mean, k = 0, is treated as a wave of twice the patch length, which suffices for a preconditioner.
    """
    k0, k1 = 2.0 * math.pi * np.fft.fftfreq(shape[0])[:, None], 2.0 * math.pi * np.fft.rfftfreq(shape[1])
    symbol = 0.5 * np.hypot(k0, k1)
    symbol[0, 0] = 0.5 * math.pi / max(shape)
    return np.asarray(symbol)


def _basis(count: int, size: int) -> FloatArray:
    """Return Chebyshev polynomials along one side, averaged over each cell, (count, size).

    The mean is that of two points at 1/sqrt(24) from the centre. The points represent a cell of side
    1/sqrt(2) and are used for both source and target. The influence then remains symmetric and equals Love's
    far field, G + h^2/24 lap G, to fourth order.
    """
    position = np.arange(count) - 0.5 * (count - 1)
    below, above = (chebvander(2.0 * (position + s) / count, size - 1) for s in (-(24**-0.5), 24**-0.5))
    return np.asarray(0.5 * (below + above))


def _coefficients(
    influence: Radial, apart: FloatArray, half_target: FloatArray, half_source: FloatArray, q: int
) -> FloatArray:
    """Return the coefficients C of m pairs, (m, q^2, q^2); the last axis belongs to the source."""
    node = np.cos(math.pi * (np.arange(q) + 0.5) / q)
    transform = (2.0 / q) * chebvander(node, q - 1).T
    transform[0] *= 0.5
    dx, dy = (
        apart[:, k, None, None]
        + half_target[:, k, None, None] * node[:, None]
        - half_source[:, k, None, None] * node
        for k in range(2)
    )
    # axes: pair, target x, target y, source x, source y
    values = influence(np.hypot(dx[:, :, None, :, None], dy[:, None, :, None, :]))
    for _ in range(4):
        values = np.tensordot(values, transform, axes=(1, 1))
    return np.ascontiguousarray(values).reshape(-1, q * q, q * q)
