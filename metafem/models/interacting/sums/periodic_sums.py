"""Sums over a rectangular grid of sites that divides a periodic cell, by cyclic Fourier transforms."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from metafem._validate import FloatArray
from metafem.material import PeriodicCell
from metafem.models._resources import THREADS
from metafem.models.interacting.sums.fft_sums import (
    CELLS_PER_THREAD,
    FEWEST_SITES,
    LATTICE_TOLERANCE,
    Lattice,
    LatticeSums,
    Spectrum,
)
from metafem.substrate import Radial
from metafem.substrate.periodic import LatticeSum


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


class PeriodicSums(LatticeSums):
    """Products with the influence matrix of a periodic cell and its derivatives, exact to rounding."""

    def __init__(
        self, lattice: Lattice, cell: PeriodicCell, substrate: Radial, real: type = np.float64
    ) -> None:
        self.lattice, self.cell, self.substrate, self.real = lattice, cell, substrate, real
        self._products = 0
        self._index = lattice.site @ np.array([lattice.shape[1], 1])
        self._padded = lattice.shape
        self._threads = THREADS if math.prod(self._padded) > CELLS_PER_THREAD else 1

    @cached_property
    def rough(self) -> LatticeSums:
        """The same sums: a period is never padded."""
        return self

    @property
    def note(self) -> str:
        """Text of the note that describes the sums."""
        rows, columns = self.lattice.shape
        return f"all periods of the {rows} x {columns} grid were summed by FFT, exact to rounding"

    @cached_property
    def _sums(self) -> LatticeSum:
        """Lattice sums at all offsets of the grid, (rows, columns)."""
        rows, columns = self.lattice.shape
        y, x = np.arange(rows) * self.cell.length / rows, np.arange(columns) * self.cell.width / columns
        return self.substrate.periodic(self.cell, *np.meshgrid(x, y))

    @property
    def self_influence(self) -> float:
        """Displacement of a site by its own load in all other periods, with the regular term [1/mm]."""
        return float(self._sums.value[0, 0])

    @cached_property
    def _influence(self) -> Spectrum:
        value = self._sums.value.copy()
        value[0, 0] = 0.0
        return self._transform(value)

    @cached_property
    def _derivatives(self) -> tuple[Spectrum, ...]:
        _, x, y, laplacian = self._sums
        return tuple(self._transform(kernel) for kernel in (laplacian, -x, -y))
