"""Sums over a square lattice by fast Fourier transforms."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.fft import next_fast_len, rfft2

from metafem._validate import FloatArray
from metafem.models._convolution import convolve
from metafem.models._resources import THREADS
from metafem.substrate import Radial

# Largest deviation of a position from the lattice, divided by the pitch, in addition to the rounding of
# coordinates.
LATTICE_TOLERANCE = 1e-9

# Number of grid cells above which a second thread saves time. Starting a thread takes as long as the
# transform of 80 x 80 cells.
CELLS_PER_THREAD = 250_000

# Smallest fraction of occupied sites; with fewer, the sums for scattered positions are used.
FEWEST_SITES = 0.1

# Number of positions among which the nearest pair is one step apart. With a tenth of the sites occupied, a
# third of the positions have such a neighbour.
TRIED = 100

# Distance, in layer thicknesses, beyond which the influence of a layer is zero to rounding.
END = 48.0

Spectrum = NDArray[np.complexfloating]


@dataclass(frozen=True, eq=False)
class Lattice:
    """Sites of a square lattice, as whole numbers of steps along its two axes."""

    site: NDArray[np.int64]  # row and column of each position, from 0, (n, 2)
    shape: tuple[int, int]  # rows and columns of the smallest rectangle that contains all sites
    pitch: float  # distance between adjacent sites [mm]


def find_lattice(position: FloatArray) -> Lattice | None:
    """Return the square lattice, of any orientation, that contains the positions (n, 2), or None."""
    if len(position) < 2:
        return None
    centre = position - position.mean(axis=0)
    middle = np.argsort(np.hypot(*centre.T), kind="stable")[:TRIED]
    distances, near = scipy.spatial.cKDTree(centre).query(centre[middle], k=2)
    # the first of the nearest pairs, which are equal to rounding
    k = int((distances[:, 1] <= distances[:, 1].min() * (1.0 + LATTICE_TOLERANCE)).argmax())
    distance, first = distances[k], centre[middle[k]]
    step = centre[near[k, 1]] - first
    extent = float(np.hypot(*centre.T).max())
    # refine the axes with ever farther positions: a single step gives the direction of a long row
    # inaccurately
    for reach in (3.0 * distance[1], math.sqrt(distance[1] * extent), 2.0 * extent):
        square = step @ step
        axes = np.array([step, [-step[1], step[0]]]) / square
        exact = (centre - first) @ axes.T
        whole = np.rint(exact)
        inside = np.hypot(*(centre - first).T) <= reach
        # least-squares fit of positions = step * whole, as complex numbers
        positions = (centre - first)[inside] @ np.array([1.0, 1.0j])
        steps = whole[inside] @ np.array([1.0, 1.0j])
        weight = float((np.abs(steps) ** 2).sum())
        if weight == 0.0:
            return None
        best = complex((np.conj(steps) * positions).sum() / weight)
        step = np.array([best.real, best.imag])
    pitch = abs(best)
    axes = np.array([step, [-step[1], step[0]]]) / pitch**2
    exact = (centre - first) @ axes.T
    whole = np.rint(exact)
    # the mean offset from whole numbers is the rounding of the position chosen as origin
    rounding = 8.0 * np.finfo(float).eps * float(np.abs(position).max()) / pitch
    offset = (exact - whole).mean(axis=0)
    if float(np.abs(exact - whole - offset).max()) > LATTICE_TOLERANCE + rounding:
        return None
    site = whole.astype(np.int64)[:, ::-1]
    site = site - site.min(axis=0)
    rows, columns = (int(size) + 1 for size in site.max(axis=0))
    if len(position) < FEWEST_SITES * rows * columns:
        return None
    if len(np.unique(site @ np.array([columns, 1]))) < len(position):
        return None
    return Lattice(site, (rows, columns), pitch)


class LatticeSums:
    """Products with the influence matrix and its derivatives, by FFTs on a padded lattice.

    The lattice is padded to twice its size, or by the distance at which the influence of a layer ends. The
    cyclic convolutions then equal the products on the bounded lattice, to rounding.
    """

    def __init__(self, lattice: Lattice, substrate: Radial, real: type = np.float64) -> None:
        self.lattice, self.substrate, self.real = lattice, substrate, real
        self._products = 0
        self._index = lattice.site @ np.array([lattice.shape[1], 1])
        far = END * getattr(substrate, "thickness", math.inf) / lattice.pitch
        self._padded = tuple(
            next_fast_len(math.ceil(min(2 * size - 1, max(size, far) + far)), real=True)
            for size in lattice.shape
        )
        self._threads = THREADS if math.prod(self._padded) > CELLS_PER_THREAD else 1

    @property
    def products(self) -> int:
        """Number of sources that were transformed until now."""
        return self._products + (self.rough._products if self.rough is not self else 0)

    @cached_property
    def rough(self) -> LatticeSums:
        """Sums in single precision, or the same sums if those would save no time."""
        if math.prod(self._padded) <= CELLS_PER_THREAD:
            return self
        return LatticeSums(self.lattice, self.substrate, np.float32)

    @property
    def self_influence(self) -> float:
        """Regular self term of a site [1/mm]."""
        return self.substrate.self_influence

    @property
    def note(self) -> str:
        """Text of the note that describes the sums."""
        rows, columns = self.lattice.shape
        return f"all pairs of the {rows} x {columns} lattice were summed by FFT, exact to rounding"

    def error(self, load: FloatArray) -> float:
        """Return the error [mm] of G p: zero, since the sums are exact to rounding."""
        return 0.0

    def displacement(
        self, load: FloatArray, size: FloatArray | None = None, *moment: FloatArray
    ) -> FloatArray:
        """Return G p, (n,) [mm]; with sizes v and moments w of the sources, return G p + lap v + grad . w.

        load: p; size: v; moment: the two components of w. lap and grad are derivatives of G at the source.
        """
        if size is None:
            return self._products_of([load], [[self._influence]])[0]
        return self._products_of([load, size, *moment], [[self._influence, *self._derivatives]])[0]

    def field(self, load: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the Laplacian and the two slopes of G p at the asperities, (n,) each."""
        # the derivative at the displaced end is the opposite of that at the source
        laplacian, x, y = self._products_of([load], [[part] for part in self._derivatives])
        return laplacian, -x, -y

    def _products_of(self, sources: list[FloatArray], spectra: list[list[Spectrum]]) -> list[FloatArray]:
        """Return the sums over the sources (n,), for each result with one transform for each source."""
        self._products += len(sources)
        shape = self.lattice.shape
        grids: list[NDArray[Any]] = [np.zeros(shape, dtype=self.real) for _ in sources]
        for grid, source in zip(grids, sources, strict=True):
            grid.ravel()[self._index] = source

        def block(columns: slice) -> list[list[Spectrum]]:
            return [[part[:, columns] for part in line] for line in spectra]

        fields = convolve(grids, block, self._padded, self._padded[1] // 2 + 1, self._threads)
        return [np.asarray(field.ravel()[self._index], dtype=np.float64) for field in fields]

    def _offsets(self, shape: tuple[int, ...]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return y, x and r [mm] of the nearest image on a cyclic grid, with r = pitch at the origin."""
        steps = [np.fft.fftfreq(size, 1.0 / size) * self.lattice.pitch for size in shape]
        y, x = np.meshgrid(*steps, indexing="ij")
        r = np.hypot(x, y)
        r[0, 0] = self.lattice.pitch
        return y, x, r

    def _transform(self, kernel: FloatArray) -> Spectrum:
        return np.asarray(rfft2(kernel, workers=THREADS), dtype=np.result_type(self.real, np.complex64))

    @cached_property
    def _influence(self) -> Spectrum:
        """Transform of G."""
        value = self.substrate.influence(self._offsets(self._padded)[2])
        value[0, 0] = 0.0
        return self._transform(value)

    @cached_property
    def _derivatives(self) -> tuple[Spectrum, ...]:
        """Transforms of lap G and of the derivatives at the source, along the axes of the lattice."""
        y, x, r = self._offsets(self._padded)
        _, first, second = self.substrate.influence(r, derivatives=True)
        first /= r
        laplacian = second + first
        laplacian[0, 0] = 2.0 * self.substrate.self_curvature
        return tuple(self._transform(kernel) for kernel in (laplacian, -first * x, -first * y))
