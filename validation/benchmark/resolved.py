"""Time of one load of resolved contacts, and its ratio to that of tamaas with the same cells.

The surface has 8 x 8 asperities on a half-space. Both use the same grid: tamaas all of it, metafem the
neighbourhoods of the contacts. tamaas is installed by the extra ``[peers]`` (AGPL-3.0; metafem does not
import it); without it only the time of metafem is measured. With cells of 6 µm tamaas takes minutes and runs
with ``--long`` only.
"""

from __future__ import annotations

import importlib.util
import math
from collections.abc import Iterator

import numpy as np

import metafem as mf
from validation.cost import peers
from validation.timing import Row, best

PITCH, RADIUS, MODULUS = 1.5, 0.526, 1.36
CELL, LOAD = 0.006, 1.5

# At this cell [mm] tamaas takes a quarter of a minute.
QUICK_CELL = 0.02

# Heights: quantiles of a truncated exponential of scale 0.04 mm up to 0.12 mm, raised by 0.084 mm.
SCALE, MAX_HEIGHT, OFFSET = 0.04, 0.12, 0.084

# Tolerance of tamaas, on its own measure of complementarity: looser than the residual of metafem, in favour
# of tamaas.
PEER_TOLERANCE = 1e-6


def scene() -> mf.Surface:
    """Return the surface, whose asperities are all in contact under `LOAD`."""
    quantile = (np.arange(64) + 0.5) / 64
    height = OFFSET - SCALE * np.log1p(quantile * math.expm1(-MAX_HEIGHT / SCALE))
    height = np.random.default_rng(1).permutation(height)
    return mf.Surface.square_lattice(height, (8, 8), PITCH, radius=RADIUS, material=mf.Material(MODULUS))


def solved(surface: mf.Surface, cell: float) -> tuple[float, float]:
    """Return the seconds of metafem, the fastest of three runs without compilation, and its area [mm²]."""
    model = mf.BoundaryElements(cell)
    seconds = best(lambda: mf.equilibrium(surface, model, load=LOAD), 3)
    return seconds, mf.equilibrium(surface, model, load=LOAD).area


def rows() -> Iterator[Row]:
    """Measure the time of one load, and compare with tamaas at coarse cells."""
    seconds, _ = solved(scene(), CELL)
    yield Row(f"one load, 64 resolved asperities, cell {1e3 * CELL:g} µm", 10.0, seconds, "s")
    yield from _compared_with_tamaas(QUICK_CELL)


def long_rows() -> list[Row]:
    """Compare with tamaas at fine cells."""
    return _compared_with_tamaas(CELL)


def _compared_with_tamaas(cell: float) -> list[Row]:
    """Compare times and areas at one size of the cells, if tamaas is installed."""
    if importlib.util.find_spec("tamaas") is None:
        return []
    surface = scene()
    seconds, area = solved(surface, cell)
    peer = peers.solve_with_tamaas(peers.Grid(surface, cell), LOAD, tolerance=PEER_TOLERANCE)
    # within the looser tolerance of tamaas
    difference = abs(area / peer.moments - 1.0)
    name = f"cell {1e3 * cell:g} µm"
    return [
        Row(f"time over that of tamaas in the same run, {name}", 0.1, seconds / peer.seconds),
        Row(f"relative difference of the areas from tamaas, {name}", 10.0 * PEER_TOLERANCE, difference),
    ]
