"""Sums over scattered positions: near pairs are summed directly, the smooth remainder on a grid.

Ewald's splitting is ``1/r = (1/r - S(r)) + S(r)``, where the smooth part S is the potential of a smooth cloud
of charge and equals 1/r outside it. The first part is summed over near pairs. The second part and the regular
part of the substrate contain only waves that a grid resolves: the sources are spread to the grid by a window,
their transform is multiplied by that of the field, and the result is interpolated by the same window.

Cloud and window have the shape ``w(x) = exp(b (sqrt(1 - x^2) - 1))`` for |x| < 1, with transforms of about
exp(-b) beyond the wavenumber b (Barnett, Magland and af Klinteberg, SIAM J. Sci. Comput. 41, C479 (2019),
doi:10.1137/18M120885X).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dctn, next_fast_len
from scipy.sparse import csr_array, vstack
from scipy.spatial import cKDTree
from scipy.special import erfc

from metafem._kernels import layer
from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.models._resources import THREADS, require_memory
from metafem.models.interacting.sums import Sums, find_grid, find_lattice
from metafem.substrate import Radial
from metafem.surface import Surface

# Shape b of the cloud and of the window, and number of grid points of the window: errors of 1e-11 of G and of
# 1e-10 of its derivatives, relative to the largest values of each.
CLOUD, WINDOW, POINTS = 24.0, 2.45 * 12, 12

# Largest wavenumber of the field, divided by that of the grid, pi per step. The window is accurate for it,
# since the longer waves, whose errors matter most, are farther from their images.
BAND = 0.7

# Number of grid steps beyond the scene within which the distance along each axis becomes constant, so that
# the field on the periodic grid is smooth. The slope of the distance follows an error function with 1/12 of
# these steps as its width. At both ends the remaining jump is 1e-17. At the end of the band, the Fourier
# components are 1e-12.
MARGIN = 80

# Pieces of the table of the near influence: on 1/32 of the reach, polynomials of degree 9 represent
# wavenumbers up to 30 over the reach with an error of 1e-13.
END = 32 * layer.WIDTH

# Nodes and weights of a quadrature over the window, from -1 to 1.
NODE, WEIGHT = np.polynomial.legendre.leggauss(80)


def window(x: FloatArray, shape: float) -> FloatArray:
    """Return the window at x [-], from -1 to 1."""
    return np.asarray(np.exp(shape * (np.sqrt(np.maximum(1.0 - x**2, 0.0)) - 1.0)))


@cache
def split_table() -> FloatArray:
    """Return the table of `metafem._kernels.layer` for minus the smooth part of 1/s, up to END.

    The smooth part is ``S(s) = W(x)/s`` with ``x = s/END`` and the integral W of the window from 0 to x,
    divided by the integral to 1. It equals 1/s at the END. In space it is the potential of a cloud of charge
    within this radius, and its transform decreases like that of the window.
    """
    weight = WEIGHT / float(WEIGHT @ window(NODE, CLOUD))

    def smooth(s: FloatArray) -> tuple[FloatArray, ...]:
        u = np.outer(s / END, NODE)
        bell, root = window(u, CLOUD), np.sqrt(1.0 - u**2)
        first = -CLOUD * u / root * bell
        second = ((CLOUD * u / root) ** 2 - CLOUD / root**3) * bell
        value = bell @ weight, first @ (NODE * weight), second @ (NODE**2 * weight)
        return tuple(-part / END**power for power, part in enumerate(value, start=1))

    return layer.tabulated(smooth, END)


@dataclass(frozen=True)
class Near(Radial):
    """The influence 1/(pi r) without its smooth part; zero beyond the reach [mm]."""

    reach: float

    def regular_derivatives(self, distance: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return minus the smooth parts of G [1/mm], G' [1/mm^2] and G'' [1/mm^3] at distances [mm]."""
        value, first, second = layer.regular(distance, self.reach / END, split_table())
        return value, first, second


class ScatteredSums(Sums):
    """Products with the influence matrix and its derivatives, for any positions, by Ewald's method."""

    def __init__(self, position: FloatArray, substrate: Radial, order: int = 3) -> None:
        self.position, self.substrate = position, substrate
        self.self_influence = substrate.self_influence
        thickness = getattr(substrate, "thickness", math.inf)
        # beyond 35 t the influence of a layer is below 2e-11 of that of a half-space for any Poisson's ratio
        far = 35.0 * thickness
        tree, some = cKDTree(position), position[:: max(1, len(position) // 100)]
        # the near pairs, and the grid with its transforms, take about the same memory and time; the spacing
        # is that of most neighbours, on which positions far away have no influence
        per_pair, per_cell = (12.0, 60.0) if order == 1 else (36.0, 200.0)
        spacing = float(np.median(tree.query(some, k=2)[0][:, 1]))
        reach, pairs, cells = min(2.0 * spacing, 0.9 * far), 0.0, math.inf
        while pairs < cells and reach < far:
            reach = min(1.2 * reach, far)
            near = float(tree.query_ball_point(some, reach, return_length=True).mean())
            # seven steps per thickness, because the Fourier components of the regular part decrease as k t
            # exp(-2 k t), then to 1e-12; one step suffices if the layer is so thin that the grid is zero
            step = min(BAND * math.pi * reach / CLOUD, thickness / 7.0)
            self._lay(step if reach < far else float(np.ptp(position)))
            pairs, cells = 0.5 * per_pair * near * len(position), per_cell * math.prod(self.span)
        needed = pairs + cells + 300.0 * len(position)
        require_memory(needed, f"the sums over {len(position)} scattered positions")
        part: Radial = Near(reach)
        way = f"pairs nearer than {reach:.3g} mm were summed directly, the rest on a grid"
        if reach == far:
            part = substrate
            way = f"pairs beyond {reach:.3g} mm were left out, where the layer is below 2e-11 of a half-space"
        self.note = f"{len(position)} scattered positions: {way}; 16 rows were checked exactly"
        place = (position - self.origin)[:, ::-1] / self.step
        first = np.ceil(place - 0.5 * POINTS)
        away = (first - place)[..., None] + np.arange(POINTS)
        self.first, self.weight = first.astype(np.int64), window(away / (0.5 * POINTS), WINDOW)
        self.spectra = self._transforms(part, order)
        # the smooth parts at the source are subtracted; the curvature of the regular part is retained
        self.own = part.self_influence - self.self_influence, 2.0 * part.self_curvature
        # about two million pairs are listed at once
        self.pairs = _upper_pairs(tree, part, reach, order, 1 + int(2e6 / near))

    def _lay(self, step: float) -> None:
        """Lay a grid of a step [mm] over the positions."""
        low, high = self.position.min(axis=0), self.position.max(axis=0)
        self.step, self.origin = step, low - (0.5 * POINTS + 1.0) * step
        self.span = np.ceil((high - self.origin)[::-1] / step + 0.5 * POINTS + 1.0).astype(int).tolist()
        self.padded = [2 * next_fast_len(size + MARGIN, real=True) for size in self.span]

    def _transforms(self, near: Radial, order: int) -> list[NDArray[np.inexact]]:
        """Return the transforms of the smooth field within the band, divided by those of both windows.

        For order 3 also those of its Laplacian, and of its derivatives by x and y at the source.
        """
        half = [size // 2 for size in self.padded]
        y, x = (self._distances(size, span) for size, span in zip(half, self.span, strict=True))
        r = np.hypot(y[:, None], x)
        field = self.substrate.regular(r)
        field -= near.regular(r)
        ky, kx = (math.pi / size * np.arange(size + 1.0) for size in half)
        quarter = dctn(field, type=1, overwrite_x=True, workers=THREADS)
        spread = WEIGHT * window(NODE, WINDOW)
        for k in (ky[:, None], kx):
            transform = 0.5 * POINTS * (np.cos(0.5 * POINTS * k[..., None] * NODE) @ spread)
            quarter *= np.where(k <= BAND * math.pi, 1.0 / transform**2, 0.0)
        value = np.concatenate([quarter, quarter[-2:0:-1]])
        if order == 1:
            return [value]
        ky, kx = np.concatenate([ky, -ky[-2:0:-1]])[:, None] / self.step, kx / self.step
        return [value, -(kx**2 + ky**2) * value, -1j * kx * value, -1j * ky * value]

    def _distances(self, half: int, span: int) -> FloatArray:
        """Return distances along half of a cyclic axis [mm], exact up to `span` steps, then constant."""
        x = np.arange(half + 1.0)
        width, middle = MARGIN / 12.0, span + 0.5 * MARGIN
        y = (x - middle) / width
        # integral of erfc((x - middle)/width)/2 from 0: x itself far below the middle
        bent = middle + 0.5 * width * (y * erfc(y) - np.exp(-(y**2)) / math.sqrt(math.pi))
        return np.asarray(self.step * np.where(x <= span, x, bent))

    def put(self, source: FloatArray) -> FloatArray:
        """Return the grid of sources (n,)."""
        field = np.zeros(self.span)
        layer.spread(self.first, self.weight, source, field)
        return field

    def take(self, field: FloatArray) -> FloatArray:
        """Return the values (n,) of a field on the padded grid."""
        result = np.empty(len(self.first))
        layer.gather(self.first, self.weight, field, result)
        return result

    def near(self, index: int, source: FloatArray) -> FloatArray:
        """Return the sum over near pairs for G, its Laplacian, or its derivatives by x or y, (n,)."""
        half, even = self.pairs[index], index < 2
        other = half.T @ source
        return np.asarray(half @ source + (other + self.own[index] * source if even else -other))

    def error(self, load: FloatArray) -> float:
        """Return the largest error [mm] of G p at some of the loaded positions."""
        loaded = np.flatnonzero(load)
        rows = loaded[:: max(1, len(loaded) // 16)]
        found = self.displacement(load)[rows]
        for k, row in enumerate(rows):
            others = loaded[loaded != row]
            r = np.hypot(*(self.position[others] - self.position[row]).T)
            found[k] -= self.substrate.influence(r) @ load[others]
        return float(np.abs(found).max(initial=0.0))


def _upper_pairs(tree: cKDTree, near: Radial, reach: float, order: int, rows: int) -> list[csr_array]:
    """Return the upper halves of the near part of G and, for order 3, of its derivatives as in `Sums`."""
    blocks, position = [], tree.data
    for start in range(0, len(position), rows):
        block = position[start : start + rows]
        found = cKDTree(block).sparse_distance_matrix(tree, reach, output_type="ndarray")
        found = found[found["j"] > found["i"] + start]
        shape = len(block), len(position)
        index = csr_array((np.arange(len(found)), (found["i"], found["j"])), shape=shape)
        found = found[index.data]
        value, first, second = near.influence(found["v"], derivatives=True)
        first /= found["v"]
        slopes = -first * (block[found["i"]] - position[found["j"]]).T
        terms = [value, second + first, *slopes][: 1 if order == 1 else 4]
        where, starts = index.indices.astype(np.int32), index.indptr.astype(np.int32)
        blocks.append([csr_array((term, where, starts), shape=shape) for term in terms])
    return [vstack(parts, format="csr") for parts in zip(*blocks, strict=True)]


def fast_sums(substrate: Radial, order: int, surface: Surface) -> Sums:
    """Return the sums for a surface."""
    if surface.cell is not None:
        grid = find_grid(surface.position, surface.cell)
        if grid is None:
            raise InvalidInput(
                f"a periodic cell with {surface.count} asperities needs sites on a rectangular grid that "
                "divides the cell; use such sites, or a smaller cell, for sums over all pairs"
            )
        return Sums(grid, substrate, order, surface.cell)
    lattice = find_lattice(surface.position)
    if lattice is None:
        return ScatteredSums(surface.position, substrate, order)
    _, shape, _ = lattice
    require_memory(32 * math.prod(shape) * (8 if order == 1 else 12), f"a lattice of {shape}")
    return Sums(lattice, substrate, order)
