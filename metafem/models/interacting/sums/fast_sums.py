"""Fast sums over the sites of a surface."""

from __future__ import annotations

import math

from metafem.errors import InvalidInput
from metafem.models._resources import require_memory
from metafem.models.interacting.sums.ewald_sums import ScatteredSums
from metafem.models.interacting.sums.fft_sums import LatticeSums, find_lattice
from metafem.models.interacting.sums.periodic_sums import PeriodicSums, find_grid
from metafem.substrate import Radial
from metafem.surface import Surface


def fast_sums(surface: Surface, substrate: Radial, order: int) -> LatticeSums | ScatteredSums:
    """Return the fast sums for a surface: by FFT if its positions form a lattice, else by Ewald's method."""
    if surface.cell is not None:
        grid = find_grid(surface.position, surface.cell)
        if grid is None:
            raise InvalidInput(
                f"a periodic cell with {surface.count} asperities needs sites on a rectangular grid that "
                "divides the cell; use such sites, or a smaller cell, for sums over all pairs"
            )
        return PeriodicSums(grid, surface.cell, substrate)
    lattice = find_lattice(surface.position)
    if lattice is None:
        scattered = ScatteredSums(surface.position, substrate)
        # positions, sources and results, and arrays on the grid
        arrays = (12, 2) if order == 1 else (24, 4)
        needed = 8 * (arrays[0] * surface.count + arrays[1] * scattered.cells)
        require_memory(needed, f"the sums over {surface.count} scattered positions")
        return scattered
    require_memory(32 * math.prod(lattice.shape) * (5 if order == 1 else 12), f"a lattice of {lattice.shape}")
    return LatticeSums(lattice, substrate)
