"""Sums over a square lattice by fast Fourier transforms."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.fft import irfft2, next_fast_len, rfft2

from metafem._validate import FloatArray
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
    """Products with the influence matrix and its derivatives, by FFTs on twice the lattice.

    With this padding the cyclic convolutions equal the products on the bounded lattice, to rounding.
    """

    def __init__(self, lattice: Lattice, substrate: Radial) -> None:
        self.lattice = lattice
        self.substrate = substrate
        self.products = 0
        self._index = lattice.site @ np.array([lattice.shape[1], 1])
        self._padded = tuple(next_fast_len(2 * size - 1, real=True) for size in lattice.shape)
        self._threads = THREADS if math.prod(self._padded) > CELLS_PER_THREAD else 1

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
        total = self._forward(load) * self._influence
        if size is not None:
            for source, spectrum in zip((size, *moment), self._derivatives, strict=True):
                total += self._forward(source) * spectrum
        return self._backward(total)

    def field(self, load: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the Laplacian and the two slopes of G p at the asperities, (n,) each."""
        load_hat = self._forward(load)
        # the derivative at the displaced end is the opposite of that at the source
        laplacian, x, y = (self._backward(load_hat * spectrum) for spectrum in self._derivatives)
        return laplacian, -x, -y

    def _grid(self, vector: FloatArray) -> FloatArray:
        grid = np.zeros(math.prod(self.lattice.shape))
        grid[self._index] = vector
        return grid.reshape(self.lattice.shape)

    def _forward(self, vector: FloatArray) -> NDArray[np.complex128]:
        self.products += 1
        return np.asarray(rfft2(self._grid(vector), self._padded, workers=self._threads))

    def _backward(self, spectrum: NDArray[np.complex128]) -> FloatArray:
        rows, columns = self.lattice.shape
        field = irfft2(spectrum, self._padded, workers=self._threads)
        return np.asarray(field[:rows, :columns].ravel()[self._index])

    def _offsets(self, shape: tuple[int, ...]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return y, x and r [mm] of the nearest image on a cyclic grid, with r = pitch at the origin."""
        steps = [np.fft.fftfreq(size, 1.0 / size) * self.lattice.pitch for size in shape]
        y, x = np.meshgrid(*steps, indexing="ij")
        r = np.hypot(x, y)
        r[0, 0] = self.lattice.pitch
        return y, x, r

    @cached_property
    def _influence(self) -> NDArray[np.complex128]:
        """Transform of G."""
        value = self.substrate.influence(self._offsets(self._padded)[2])
        value[0, 0] = 0.0
        return np.asarray(rfft2(value, workers=THREADS))

    @cached_property
    def _derivatives(self) -> tuple[NDArray[np.complex128], ...]:
        """Transforms of lap G and of the derivatives at the source, along the axes of the lattice."""
        y, x, r = self._offsets(self._padded)
        _, first, second = self.substrate.influence(r, derivatives=True)
        first /= r
        laplacian = second + first
        laplacian[0, 0] = 2.0 * self.substrate.self_curvature
        return tuple(rfft2(kernel, workers=THREADS) for kernel in (laplacian, -first * x, -first * y))
