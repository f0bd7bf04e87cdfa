"""Products with the influence between the sites of large scenes, by fast Fourier transforms on a grid.

If the sites are nodes of a lattice, the grid is the lattice, padded so that the cyclic convolution equals the
sum over all pairs. If they are nodes of a grid that divides a periodic cell, nothing is padded. Other sites
are spread to a grid by a window, which represents the smooth part of the influence, and the rest is summed
over near pairs, see `metafem.models.interacting.scattered`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.fft import irfft2, next_fast_len, rfft2
from scipy.linalg.lapack import dpotrf, dpotrs
from scipy.sparse import csr_array

from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.material import PeriodicCell
from metafem.models._resources import THREADS, require_memory
from metafem.substrate import Radial
from metafem.substrate.periodic import BATCH

Spectrum = NDArray[np.inexact]

# Largest deviation of a position from the lattice, divided by the pitch, in addition to the rounding of
# coordinates: an error of 1e-9 of the influence.
LATTICE_TOLERANCE = 1e-9


# Sites of a lattice: the index of each position in the flat grid (n,), the numbers of rows and columns, and
# the distance between adjacent sites of a row [mm].
Lattice = tuple[NDArray[np.int64], tuple[int, int], float]

# A preconditioner for a diagonal (n,), see `coarse_model`.
Preconditioner = Callable[[FloatArray], Callable[[FloatArray], FloatArray]]


def find_lattice(position: FloatArray) -> Lattice | None:
    """Return the square lattice along x and y that contains the positions (n, 2), or None."""
    offset = (position - position.min(axis=0))[:, ::-1]
    extent, rounding = float(offset.max()), 8.0 * np.finfo(float).eps * float(np.abs(position).max())
    steps = np.diff(np.sort(offset, axis=0), axis=0)
    steps = steps[steps > LATTICE_TOLERANCE * extent + rounding]  # between different rows or columns
    if not steps.size:
        return None
    pitch = extent / float(np.rint(extent / steps.min()))
    exact = offset / pitch
    site = np.rint(exact)
    # the mean offset from whole numbers is the rounding of the lowest positions
    error = exact - site - (exact - site).mean(axis=0)
    if float(np.abs(error).max()) > LATTICE_TOLERANCE + rounding / pitch:
        return None
    return _occupied(site, (int(site[:, 0].max()) + 1, int(site[:, 1].max()) + 1), pitch)


def find_grid(position: FloatArray, cell: PeriodicCell) -> Lattice | None:
    """Return the sites as whole steps of the coarsest grid that divides the cell along x and y, or None."""
    sides = np.array([cell.length, cell.width])
    offset = np.mod((position - position[0])[:, ::-1], sides) / sides
    offset[offset > 1.0 - LATTICE_TOLERANCE] = 0.0
    size = np.rint(1.0 / np.where(offset > LATTICE_TOLERANCE, offset, 1.0).min(axis=0))
    site = np.rint(offset * size)
    if (np.abs(offset * size - site) > size * LATTICE_TOLERANCE).any():
        return None
    return _occupied(np.mod(site, size), (int(size[0]), int(size[1])), cell.width / float(size[1]))


def _occupied(site: FloatArray, shape: tuple[int, int], pitch: float) -> Lattice | None:
    """Return a lattice with sites (n, 2), or None if too few are occupied, or one twice."""
    index = (site @ np.array([shape[1], 1])).astype(np.int64)
    few = len(index) < 0.1 * math.prod(shape)  # the sums for scattered positions then take less time
    return None if few or len(np.unique(index)) < len(index) else (index, shape, pitch)


class Sums:
    """Products with the influence matrix G, without its diagonal, and with its derivatives.

    The sites form a square lattice, or a grid that divides a periodic cell; the products are then exact to
    rounding. For order 1 there is G alone. The axes of slopes and moments are those of the grid.
    """

    products = 0  # number of sources that were transformed until now

    def __init__(
        self, lattice: Lattice, substrate: Radial, order: int = 3, cell: PeriodicCell | None = None
    ) -> None:
        self.index, self.shape, pitch = lattice
        rows, columns = self.shape
        if cell is None:
            # beyond 48 thicknesses the influence of a layer is zero to rounding
            far = 48.0 * getattr(substrate, "thickness", math.inf) / pitch
            self.padded = [
                next_fast_len(math.ceil(min(2 * size - 1, max(size, far) + far)), real=True)
                for size in self.shape
            ]
            y, x = (np.fft.fftfreq(size, 1.0 / size) * pitch for size in self.padded)
            r = np.hypot(y[:, None], x)
            r[0, 0] = pitch
            value, first, second = substrate.influence(r, derivatives=True)
            first /= r
            laplacian = second + first
            laplacian[0, 0] = 2.0 * substrate.self_curvature
            terms = [value, laplacian, -first * x, -first * y[:, None]]
            self.self_influence, what = substrate.self_influence, "pairs of the {} x {} lattice"
        else:
            self.padded = [rows, columns]
            require_series(cell, substrate, rows * columns)
            x, y = np.arange(columns) * cell.width / columns, np.arange(rows) * cell.length / rows
            value, slope_x, slope_y, laplacian = substrate.periodic(cell, *np.meshgrid(x, y))
            terms = [value, laplacian, -slope_x, -slope_y]
            # a site is displaced by its own load in all other periods
            self.self_influence, what = float(value[0, 0]), "periods of the {} x {} grid"
        value[0, 0] = 0.0
        self.note = f"all {what.format(rows, columns)} were summed by FFT, exact to rounding"
        # of G, and of its Laplacian and its derivatives by x and y at the source
        self.spectra: Sequence[Spectrum] = [
            np.asarray(rfft2(term, workers=THREADS)) for term in terms[: 1 if order == 1 else 4]
        ]

    def put(self, source: FloatArray) -> FloatArray:
        """Return the grid of sources (n,)."""
        grid = np.zeros(self.shape)
        grid.ravel()[self.index] = source
        return grid

    def take(self, field: FloatArray) -> FloatArray:
        """Return the values (n,) of a field on the padded grid."""
        rows, columns = self.shape
        return np.asarray(field[:rows, :columns].ravel()[self.index])

    def near(self, index: int, source: FloatArray) -> FloatArray | float:
        """Return what the grid lacks of G, its Laplacian, or its derivatives by x or y, (n,)."""
        return 0.0

    def error(self, load: FloatArray) -> float:
        """Return the largest error [mm] of G p at some of the loaded sites."""
        return 0.0

    def displacement(
        self, load: FloatArray, size: FloatArray | None = None, *moment: FloatArray
    ) -> FloatArray:
        """Return G p, (n,) [mm]; with sizes v and moments w of the sources, return G p + lap v + grad . w.

        load: p; size: v; moment: the two components of w. lap and grad are derivatives of G at the source.
        """
        sources = [load] if size is None else [load, size, *moment]
        wave = sum((self.spectra[k] * self._wave(p) for k, p in enumerate(sources)), np.zeros(1))
        return self._values(wave) + sum(self.near(k, source) for k, source in enumerate(sources))

    def field(self, load: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the Laplacian and the two slopes of G p at the asperities, (n,) each."""
        wave = self._wave(load)
        laplacian, x, y = (self._values(self.spectra[k] * wave) + self.near(k, load) for k in (1, 2, 3))
        # the derivative at the displaced end is the opposite of that at the source
        return laplacian, -x, -y

    def _wave(self, source: FloatArray) -> Spectrum:
        """Return the transform of sources (n,)."""
        self.products += 1
        return np.asarray(rfft2(self.put(source), self.padded, workers=self._threads))

    def _values(self, wave: Spectrum) -> FloatArray:
        """Return the values (n,) of a field with a transform."""
        return self.take(irfft2(wave, self.padded, workers=self._threads, overwrite_x=True))

    @property
    def _threads(self) -> int:
        # a second thread saves time above 250,000 cells (measured)
        return THREADS if math.prod(self.padded) > 250_000 else 1


def require_series(cell: PeriodicCell, substrate: Radial, points: int) -> None:
    """Raise InvalidInput if the Fourier series of a periodic influence does not fit into the memory."""
    waves = [substrate.last_wavenumber * side / (2.0 * math.pi) for side in (cell.width, cell.length)]
    # the series with its derivatives, and the phases of a batch of points
    needed = 8.0 * (6.0 * math.prod(waves) + 3.0 * min(points, BATCH) * sum(waves))
    require_memory(needed, f"the {math.prod(waves):.2g} waves of {substrate!r} in {cell!r}")


def coarse_grid(position: FloatArray, substrate: Radial) -> tuple[csr_array, FloatArray]:
    """Return the weights of a bilinear interpolation (n, m) from the m nodes of a square grid over the scene.

    Also return the influence of the nodes on each other, (m, m) [1/mm].
    """
    count = len(position)
    low = position.min(axis=0)
    extent = np.maximum(position.max(axis=0) - low, 1e-12 * float(np.ptp(position)))
    # a matrix of 100 nodes is factorised in a fraction of a millisecond, one of 1600 in a tenth of a
    # second, which is short for 200 asperities per node; fewer than 16 per node save no products
    nodes = max(1.0, min(100, count / 16), min(1600, count / 200))
    size = max(math.sqrt(float(extent[0] * extent[1]) / nodes), float(extent.max()) / nodes)
    place = (position - low)[:, ::-1] / size
    cell = np.floor(place).astype(np.int64)
    rows, columns = (int(most) + 2 for most in cell.max(axis=0))
    y, x = (place - cell).T
    corner = cell @ np.array([columns, 1])
    nearest = corner[:, None] + np.array([0, 1, columns, columns + 1])
    weight = np.column_stack([(1.0 - y) * (1.0 - x), (1.0 - y) * x, y * (1.0 - x), y * x])
    starts = np.arange(0, 4 * count + 1, 4)
    hats = csr_array((weight.ravel(), nearest.ravel(), starts), shape=(count, rows * columns))
    # influence [1/mm] of a cloud of the size of a cell: at the centre of a square of side 1, the mean of
    # 1/r is 3.525, and the mean over the square is 2.973
    offset = size * np.abs(np.fft.fftfreq(2 * max(rows, columns), 0.5 / max(rows, columns)))
    table = substrate.influence(np.hypot(np.hypot(offset[:, None], offset), size / 2.973))
    # without the waves of negative influence, which a thin layer has on a grid wider than its thickness
    table = irfft2(np.maximum(rfft2(table).real, 0.0), s=table.shape)
    row, column = np.divmod(np.arange(rows * columns), columns)
    influence = table[np.abs(row[:, None] - row), np.abs(column[:, None] - column)]
    return hats, influence


def coarse_model(position: FloatArray, substrate: Radial) -> Preconditioner:
    """Return a function of D (n,) [mm] whose result approximates (1/D + G)^-1 v.

    The long waves of the influence G are those between the nodes of `coarse_grid`, which share the loads of
    an asperity with the weights E of the interpolation. With the influence K of the nodes on each other,
    Woodbury's formula for ``(1/D + E K E')^-1`` is ``v -> D v - D E Q E' D v`` with ``Q = (K^-1 + M)^-1``,
    where M is E' D E with the sum of each row on its diagonal. It is positive definite for any D > 0, because
    ``(E' D v).Q E' D v`` is at most ``(E' D v).M^-1 E' D v``, which is at most v.D v by the Cauchy-Schwarz
    inequality.
    """
    hats, influence = coarse_grid(position, substrate)
    sharing = hats.T.tocsr()

    def preconditioner(inverse: FloatArray) -> Callable[[FloatArray], FloatArray]:
        root = np.sqrt(sharing @ inverse)
        inner = np.eye(len(root)) + root[:, None] * influence * root
        # called directly: the checks of `scipy.linalg.cho_solve` take longer than the solution
        factor, failed = dpotrf(inner, lower=1, overwrite_a=1)
        if failed:
            raise NotConverged("the coarse model of the contacts is not positive definite")

        def apply(vector: FloatArray) -> FloatArray:
            phi = influence @ (sharing @ (inverse * vector))
            phi -= influence @ (root * dpotrs(factor, root * phi, lower=1)[0])
            return np.asarray(inverse * (vector - hats @ phi))

        return apply

    return preconditioner
