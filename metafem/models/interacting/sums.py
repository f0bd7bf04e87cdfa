"""Products with the influence between the sites of large scenes, by fast Fourier transforms on a grid.

If the sites are nodes of a lattice, the grid is the lattice, padded so that the cyclic convolution equals the
sum over all pairs. If they are nodes of a grid that divides a periodic cell, nothing is padded. Other sites
are spread to a grid by a window, which represents the smooth part of the influence, and the rest is summed
over near pairs, see `metafem.models.interacting.scattered`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray
from scipy.fft import next_fast_len, rfft2

from metafem._validate import FloatArray
from metafem.material import PeriodicCell
from metafem.models._convolution import convolve
from metafem.models._resources import THREADS, require_memory
from metafem.substrate import Radial
from metafem.substrate.periodic import BATCH

# Largest deviation of a position from the lattice, divided by the pitch, in addition to the rounding of
# coordinates: an error of 1e-9 of the influence.
LATTICE_TOLERANCE = 1e-9

# Smallest fraction of occupied sites: with fewer, the sums for scattered positions take less time.
FEWEST_SITES = 0.1

# Number of grid cells above which a second thread saves time (measured).
CELLS_PER_THREAD = 250_000

# Signs of the transposes of G, its Laplacian and its derivatives by x and y.
SIGNS = (1.0, 1.0, -1.0, -1.0)


@dataclass(frozen=True, eq=False)
class Lattice:
    """Sites of a lattice, as whole numbers of steps along its two axes."""

    site: NDArray[np.int64]  # row and column of each position, from 0, (n, 2)
    shape: tuple[int, int]  # rows and columns
    pitch: float  # distance between adjacent sites of a row [mm]


def find_lattice(position: FloatArray) -> Lattice | None:
    """Return the square lattice, of any orientation, that contains the positions (n, 2), or None."""
    if len(position) < 2:
        return None
    centre = position - position.mean(axis=0)
    # a tenth of the sites suffices: among the hundred in the middle, a third then have a nearest neighbour
    middle = np.argsort(np.hypot(*centre.T), kind="stable")[:100]
    distances, near = scipy.spatial.cKDTree(centre).query(centre[middle], k=2)
    # the first of the nearest pairs, which are equal to rounding
    k = int((distances[:, 1] <= distances[:, 1].min() * (1.0 + LATTICE_TOLERANCE)).argmax())
    from_first = (centre - centre[middle[k]]) @ np.array([1.0, 1.0j])
    step, extent = complex(from_first[near[k, 1]]), float(np.abs(from_first).max())
    # refined with ever farther positions: a single step gives the direction of a long row inaccurately
    for reach in (3.0 * abs(step), math.sqrt(abs(step) * extent), extent):
        place = from_first[np.abs(from_first) <= reach] / step
        whole = np.rint(place.real) + 1.0j * np.rint(place.imag)
        step *= complex(np.vdot(whole, place) / np.vdot(whole, whole))
    place = from_first / step
    exact = np.column_stack([place.imag, place.real])
    site = np.rint(exact)
    # the mean offset from whole numbers is the rounding of the position chosen as origin
    offset = exact - site - (exact - site).mean(axis=0)
    rounding = 8.0 * np.finfo(float).eps * float(np.abs(position).max()) / abs(step)
    if float(np.abs(offset).max()) > LATTICE_TOLERANCE + rounding:
        return None
    return _occupied((site - site.min(axis=0)).astype(np.int64), abs(step))


def _occupied(site: NDArray[np.int64], pitch: float) -> Lattice | None:
    """Return the smallest lattice that contains sites (n, 2), or None if too few are occupied, or one twice."""
    rows, columns = (int(size) + 1 for size in site.max(axis=0))
    few = len(site) < FEWEST_SITES * rows * columns
    if few or len(np.unique(site @ np.array([columns, 1]))) < len(site):
        return None
    return Lattice(site, (rows, columns), pitch)


def find_grid(position: FloatArray, cell: PeriodicCell) -> Lattice | None:
    """Return the sites as whole steps of the coarsest grid that divides the cell along x and y, or None."""
    sites, sizes = [], []
    for place, side in zip(position.T[::-1], (cell.length, cell.width), strict=True):
        offset = np.mod(place - place[0], side) / side
        offset[offset > 1.0 - LATTICE_TOLERANCE] = 0.0
        positive = offset[offset > LATTICE_TOLERANCE]
        size = round(1.0 / float(positive.min())) if positive.size else 1
        whole = np.rint(offset * size)
        if float(np.abs(offset * size - whole).max()) > size * LATTICE_TOLERANCE:
            return None
        sites.append(whole.astype(np.int64) % size)
        sizes.append(size)
    if len(position) < FEWEST_SITES * math.prod(sizes):
        return None
    return Lattice(np.stack(sites, axis=1), (sizes[0], sizes[1]), cell.width / sizes[1])


@dataclass(eq=False)
class Sums:
    """Products with the influence matrix G, without its diagonal, and with its derivatives.

    The axes of slopes and moments are those of the grid. Near pairs are the upper halves of the matrices.
    """

    put: Callable[[FloatArray], FloatArray]  # returns the grid of sources (n,)
    take: Callable[[FloatArray], FloatArray]  # returns the values (n,) on a grid
    spectra: Sequence[NDArray[np.inexact]]  # of G; for order 3 of lap G and of d/dx, d/dy G at the source too
    padded: tuple[int, int]
    self_influence: float  # of a site by itself, without the influence of its contact [1/mm]
    note: str
    near: Sequence[scipy.sparse.csr_array] = ()
    own: Sequence[float] = ()  # diagonals of near pairs of G and of its Laplacian
    error: Callable[[FloatArray], float] = lambda load: 0.0  # largest error of G p at some sites [mm]
    products: int = 0  # sources that were transformed until now

    def displacement(
        self, load: FloatArray, size: FloatArray | None = None, *moment: FloatArray
    ) -> FloatArray:
        """Return G p, (n,) [mm]; with sizes v and moments w of the sources, return G p + lap v + grad . w.

        load: p; size: v; moment: the two components of w. lap and grad are derivatives of G at the source.
        """
        sources = [load] if size is None else [load, size, *moment]
        total = self._on_grid(sources, [self.spectra[: len(sources)]])[0]
        for index, source in enumerate(sources):
            self._add_near(index, source, total)
        return total

    def field(self, load: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the Laplacian and the two slopes of G p at the asperities, (n,) each."""
        results = self._on_grid([load], [[part] for part in self.spectra[1:]])
        for index, total in enumerate(results, start=1):
            self._add_near(index, load, total)
        laplacian, x, y = results
        # the derivative at the displaced end is the opposite of that at the source
        return laplacian, -x, -y

    def _add_near(self, index: int, source: FloatArray, total: FloatArray) -> None:
        if self.near:
            half = self.near[index]
            total += half @ source
            total += SIGNS[index] * (half.T @ source)
            if index < len(self.own):
                total += self.own[index] * source

    def _on_grid(
        self, sources: Sequence[FloatArray], spectra: Sequence[Sequence[NDArray[np.inexact]]]
    ) -> list[FloatArray]:
        """Return the sums over the sources (n,), for each result with one transform for each source."""
        self.products += len(sources)
        if not self.spectra[0].size:
            return [np.zeros_like(sources[0]) for _ in spectra]

        def block(columns: slice) -> list[list[NDArray[np.inexact]]]:
            return [[part[:, columns] for part in line] for line in spectra]

        threads = THREADS if math.prod(self.padded) > CELLS_PER_THREAD else 1
        waves = self.spectra[0].shape[1]
        fields = convolve([self.put(source) for source in sources], block, self.padded, waves, threads)
        return [self.take(field) for field in fields]


def lattice_sums(
    lattice: Lattice, substrate: Radial, order: int = 3, cell: PeriodicCell | None = None
) -> Sums:
    """Return the sums over a square lattice, or over a grid that divides a periodic cell, exact to rounding."""
    rows, columns = lattice.shape
    if cell is None:
        # beyond 48 thicknesses the influence of a layer is zero to rounding
        far = 48.0 * getattr(substrate, "thickness", math.inf) / lattice.pitch
        padded = tuple(
            next_fast_len(math.ceil(min(2 * size - 1, max(size, far) + far)), real=True)
            for size in lattice.shape
        )
        steps = (np.fft.fftfreq(size, 1.0 / size) * lattice.pitch for size in padded)
        y, x = np.meshgrid(*steps, indexing="ij")
        r = np.hypot(x, y)
        r[0, 0] = lattice.pitch
        own, what = substrate.self_influence, "pairs of the {} x {} lattice"
        if order == 1:
            terms = [substrate.influence(r)]
        else:
            value, first, second = substrate.influence(r, derivatives=True)
            first /= r
            second += first
            second[0, 0] = 2.0 * substrate.self_curvature
            terms = [value, second, -first * x, -first * y]
    else:
        padded = rows, columns
        require_series(cell, substrate, rows * columns)
        x, y = np.arange(columns) * cell.width / columns, np.arange(rows) * cell.length / rows
        value, slope_x, slope_y, laplacian = substrate.periodic(cell, *np.meshgrid(x, y))
        own, what = float(value[0, 0]), "periods of the {} x {} grid"
        terms = [value, laplacian, -slope_x, -slope_y]
    terms[0][0, 0] = 0.0
    index = lattice.site @ np.array([columns, 1])

    def put(source: FloatArray) -> FloatArray:
        grid = np.zeros((rows, columns))
        grid.ravel()[index] = source
        return grid

    return Sums(
        put,
        lambda field: np.asarray(field.ravel()[index]),
        [np.asarray(rfft2(term, workers=THREADS)) for term in terms],
        (padded[0], padded[1]),
        own,
        f"all {what.format(rows, columns)} were summed by FFT, exact to rounding",
    )


def require_series(cell: PeriodicCell, substrate: Radial, points: int) -> None:
    """Raise InvalidInput if the Fourier series of a periodic influence does not fit into the memory."""
    waves = [substrate.last_wavenumber * side / (2.0 * math.pi) for side in (cell.width, cell.length)]
    # the series with its derivatives, and the phases of a batch of points
    needed = 8.0 * (6.0 * math.prod(waves) + 3.0 * min(points, BATCH) * sum(waves))
    require_memory(needed, f"the {math.prod(waves):.2g} waves of {substrate!r} in {cell!r}")
