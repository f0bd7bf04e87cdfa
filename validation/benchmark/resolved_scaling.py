"""Time, memory and error of resolved contacts as the cells become finer.

The surface has 8 x 8 asperities at a pitch of 1.5 mm, all in contact under P/E* = 0.2 mm². One grid over the
surface would have 1024², 2048² and 4096² cells; metafem has cells in the neighbourhoods of the contacts only.
With ``--long``, the neighbourhoods alone have as many cells as a grid of 4096². Each load is solved in a new
process, because only this gives its peak of memory.
"""

from __future__ import annotations

import multiprocessing
import resource
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import metafem as mf
from validation.timing import Row

COUNTS = (1024, 2048, 4096)
PITCH, RADIUS, MODULUS, THICKNESS = 1.5, 0.526, 1.36, 7.2
WIDTH = 8 * PITCH

# Heights are equally distributed between these [mm]; all asperities are in contact under this P/E* [mm²].
HEIGHTS, RESCALED_LOAD = (0.12, 0.14), 0.2

# Cells per side of a grid over the surface for which the neighbourhoods have 4096² cells.
FINEST = 27_600

# Seconds on two cores and memory [GiB] that one load may need, however its cells are counted.
SECONDS, MEMORY = 60.0, 8.0

# Error of A0 by the cells times the square of the cells per radius; its rate in the cell is within scatter 2.
ERROR = 0.37

# Bytes in each unit of the largest memory that the system reports.
REPORTED = 1 if sys.platform == "darwin" else 1024


@dataclass(frozen=True)
class Measured:
    """One load: seconds, peak of memory [GiB], products with the influence, area [mm²] and cells."""

    seconds: float
    memory: float
    products: int
    area: float
    cells: int


def scene() -> mf.Surface:
    """Return the surface on a block."""
    height = np.random.default_rng(0).uniform(*HEIGHTS, 64)
    block = mf.Block(20.0, 20.0, THICKNESS)
    material = mf.Material(MODULUS)
    return mf.Surface.square_lattice(height, (8, 8), PITCH, radius=RADIUS, material=material, block=block)


def solved(substrate: mf.HalfSpace | mf.BondedLayer, count: int) -> Measured:
    """Solve one load with cells of which `count` fit along the surface, in this process."""
    from metafem.models.boundary_elements.influence import Influence

    surface, load = scene(), RESCALED_LOAD * MODULUS
    mf.equilibrium(surface, mf.BoundaryElements(0.03, substrate), load=load)  # compiles the kernels
    products = 0
    plain = Influence.product

    def counted(operator: Influence, pressure: np.ndarray) -> np.ndarray:
        nonlocal products
        products += 1
        return plain(operator, pressure)

    Influence.product = counted  # type: ignore[method-assign, assignment]
    start = time.perf_counter()
    state = mf.equilibrium(surface, mf.BoundaryElements(WIDTH / count, substrate), load=load)
    seconds = time.perf_counter() - start
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * REPORTED / 2**30
    assert state.field is not None
    return Measured(seconds, peak, products, state.area, state.field.pressure.size)


def in_new_process(substrate: mf.HalfSpace | mf.BondedLayer, count: int) -> Measured:
    """Solve one load in a new process."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        return pool.apply(solved, (substrate, count))


def rows() -> Iterator[Row]:
    """Measure grids of 1024² to 4096² cells over the surface, and the rate of the error."""
    for substrate in (mf.HalfSpace(), mf.BondedLayer()):
        found = {count: in_new_process(substrate, count) for count in COUNTS}
        order_3 = mf.equilibrium(scene(), mf.Interacting(3, substrate), load=RESCALED_LOAD * MODULUS).area
        # the error is proportional to the square of the cell, up to scatter
        coarser, finest = found[COUNTS[-2]], found[COUNTS[-1]]
        exact = finest.area + (finest.area - coarser.area) / 3.0
        for count, each in found.items():
            name = f"{substrate.name}, {count}²"
            per_radius = np.sqrt(each.area / (64.0 * np.pi)) * count / WIDTH
            yield Row(f"{name}: one load, {each.cells} cells", SECONDS, each.seconds, "s")
            yield Row(f"{name}: peak of memory", MEMORY, each.memory, "GiB")
            yield Row(f"{name}: products", np.inf, float(each.products))
            error = abs(each.area / exact - 1.0)
            yield Row(f"{name}: error of A0 by the cells", ERROR / per_radius**2, error)
        yield Row(f"{substrate.name}: A0 of order 3", 2.5e-3, abs(order_3 / exact - 1.0))


def long_rows() -> Iterator[Row]:
    """Measure neighbourhoods with 4096² cells."""
    for substrate in (mf.HalfSpace(), mf.BondedLayer()):
        each = in_new_process(substrate, FINEST)
        name = f"{substrate.name}, {each.cells} cells in contact"
        yield Row(f"{name}: one load", SECONDS, each.seconds, "s")
        yield Row(f"{name}: peak of memory", MEMORY, each.memory, "GiB")
        yield Row(f"{name}: products", np.inf, float(each.products))
