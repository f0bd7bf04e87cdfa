"""Products with the influence matrix of all cells, without storing this matrix, and a preconditioner."""

from __future__ import annotations

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
from scipy import fft

from metafem._kernels import love
from metafem._validate import FloatArray
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


# Largest number of cells of patches that are transformed together. Small patches share the cost of calls;
# several groups remain, which distribute the work over the threads.
CELLS_PER_GROUP = 8192

# Largest number of values that are transformed at once with their padding: 16 MiB.
BLOCK = 2**20


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
        self.groups = _groups(shapes)
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
        moments = np.empty((len(sources), self.far.size, self.far.size))

        def near(group: list[int]) -> None:
            source = _stacked(sources, group)
            image = _convolved(source, self.spectra[self.shapes[group[0]]], self._threads)
            _spread(image, targets, group)

        def gather(group: list[int]) -> None:
            moments[group] = self.far.moments(_stacked(sources, group), self.shapes[group[0]])

        def far(group: list[int]) -> None:
            shift = self.far.displacement(local[group], self.shapes[group[0]])
            for k, part in zip(group, shift, strict=True):
                targets[k] += part

        if len(sources) == 1:
            near([0])
            return result
        with ThreadPoolExecutor(THREADS) as pool:
            list(pool.map(gather, self.groups))
            between = pool.submit(self.far.local, moments)
            list(pool.map(near, self.groups))
            local = between.result()
            list(pool.map(far, self.groups))
        return result

    def precondition(self, vector: FloatArray) -> FloatArray:
        """Return an approximate solution on each patch: the inverse symbol of the half-space is applied."""
        result = np.empty_like(vector)
        sources, targets = self.split(vector), self.split(result)

        def solve(group: list[int]) -> None:
            rows, columns = shape = self.shapes[group[0]]
            size, workers = _fast(shape), self._threads
            wave = fft.rfft2(_stacked(sources, group), s=size, workers=workers)
            wave *= self.symbols[shape]
            image = fft.irfft2(wave, s=size, overwrite_x=True, workers=workers)
            _spread(image[:, :rows, :columns], targets, group)

        if len(self.groups) == 1:
            solve(self.groups[0])
        else:
            with ThreadPoolExecutor(THREADS) as pool:
                list(pool.map(solve, self.groups))
        return result

    @property
    def _threads(self) -> int:
        """Number of threads in each group of patches: several groups are distributed over the threads."""
        return THREADS if len(self.groups) == 1 else 1


def _groups(shapes: list[tuple[int, int]]) -> list[list[int]]:
    """Return groups of patches of equal shape, each with at most `CELLS_PER_GROUP` cells or one patch."""
    groups = []
    for shape in sorted(set(shapes), reverse=True):
        same = [k for k, other in enumerate(shapes) if other == shape]
        count = max(1, CELLS_PER_GROUP // math.prod(shape))
        groups += [same[k : k + count] for k in range(0, len(same), count)]
    return groups


def _stacked(parts: list[FloatArray], group: list[int]) -> FloatArray:
    """Return the parts of a group of patches as one array, (k, rows, columns)."""
    return parts[group[0]][None] if len(group) == 1 else np.stack([parts[k] for k in group])


def _spread(stack: FloatArray, parts: list[FloatArray], group: list[int]) -> None:
    """Write an array (k, rows, columns) to the parts of a group of patches."""
    for k, part in zip(group, stack, strict=True):
        parts[k][...] = part


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


def _convolved(source: FloatArray, spectrum: FloatArray, threads: int) -> FloatArray:
    """Return the convolutions of patches, (k, rows, columns).

    Lines that contain only padding are not transformed. The columns are transformed in blocks, so that their
    padding needs little memory.
    """
    count, rows, columns = source.shape
    m0, m1 = _padded((rows, columns))
    work = fft.rfft(source, m1, axis=2, workers=threads)
    step = max(1, BLOCK // (count * m0))
    for start in range(0, work.shape[2], step):
        block = slice(start, start + step)
        wave = fft.fft(work[:, :, block], m0, axis=1, workers=threads)
        wave *= spectrum[:, block]
        wave = fft.ifft(wave, axis=1, overwrite_x=True, workers=threads)
        work[:, :, block] = wave[:, :rows]
    result = np.empty_like(source)
    step = max(1, BLOCK // (count * m1))
    for start in range(0, rows, step):
        block = slice(start, start + step)
        result[:, block] = fft.irfft(work[:, block], m1, axis=2, workers=threads)[:, :, :columns]
    return result


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
