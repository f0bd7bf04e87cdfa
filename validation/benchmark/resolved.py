"""Resolved contacts beside tamaas: one load of an 8 x 8 surface on a half-space, same cells.

Run as ``python validation/benchmark/resolved.py [--cell 0.006] [--load 1.5]``. Needs tamaas, extra
``[peers]`` (AGPL-3.0; it is imported here and nowhere in metafem). Both solvers get the same grid:
tamaas the whole of it and metafem the neighbourhoods of the contacts. The first call of metafem, which
compiles, is not counted; of its runs the fastest is.
"""

from __future__ import annotations

import argparse
import math
import time

import numpy as np
import tamaas
from scipy.fft import next_fast_len

import metafem as mf

PITCH, RADIUS, MODULUS = 1.5, 0.526, 1.36

# Heights: quantiles of a truncated exponential of scale 0.04 mm up to 0.12 mm, raised by 0.084 mm.
SCALE, MAX_HEIGHT, OFFSET = 0.04, 0.12, 0.084

# Runs of metafem, of which the fastest counts.
REPEATS = 3

# What tamaas is asked for, on its own measure of complementarity: looser than metafem's residual, in
# favour of tamaas.
PEER_TOLERANCE = 1e-6

WANTED_SECONDS, WANTED_RATIO = 10.0, 10.0


def scene(cell: float) -> tuple[mf.Surface, int]:
    """Return the surface, and the number of cells a side of tamaas' grid."""
    share = (np.arange(64) + 0.5) / 64
    height = OFFSET - SCALE * np.log1p(share * math.expm1(-MAX_HEIGHT / SCALE))
    height = np.random.default_rng(1).permutation(height)
    surface = mf.Surface.square_lattice(height, (8, 8), PITCH, radius=RADIUS, material=mf.Material(MODULUS))
    # as far as half a pitch beyond the lattice, and a number that its transforms like
    return surface, next_fast_len(math.ceil(8.0 * PITCH / cell))


def solve_with_tamaas(surface: mf.Surface, cell: float, side: int, load: float) -> tuple[float, ...]:
    """Return seconds, load [N], area by moments [mm^2] and tamaas' own error."""
    # the middle cell stands on the centre of the surface, as in metafem's grid
    x = cell * (np.arange(side) - side // 2)
    depth = np.full((side, side), np.inf)
    for (cx, cy), height in zip(surface.position, surface.height, strict=True):
        i = np.flatnonzero(abs(x - cx) <= 0.5 * PITCH)
        j = np.flatnonzero(abs(x - cy) <= 0.5 * PITCH)
        paraboloid = (x[i, None] - cx) ** 2 + (x[None, j] - cy) ** 2
        depth[np.ix_(i, j)] = -height + paraboloid / (2.0 * RADIUS)
    depth[~np.isfinite(depth)] = depth[np.isfinite(depth)].max()
    length = side * cell
    model = tamaas.Model(tamaas.model_type.basic_2d, [length, length], [side, side])
    model.E, model.nu = MODULUS, 0.0
    tamaas.ModelFactory.registerNonPeriodic(model, "dcfft")
    solver = tamaas.PolonskyKeerRey(model, -depth, PEER_TOLERANCE)
    solver.setIntegralOperator("dcfft")
    solver.max_iter = 2000
    begin = time.perf_counter()
    error = solver.solve(load / length**2)
    seconds = time.perf_counter() - begin
    area = 0.0
    for cx, cy in surface.position:
        i = np.flatnonzero(abs(x - cx) <= 0.5 * PITCH)
        j = np.flatnonzero(abs(x - cy) <= 0.5 * PITCH)
        area += ellipse(x[i], x[j], model.traction[np.ix_(i, j)])
    return seconds, float(model.traction.sum()) * cell**2, area, error


def ellipse(x: np.ndarray, y: np.ndarray, pressure: np.ndarray) -> float:
    """Return 5 pi sqrt(<x^2><y^2> - <xy>^2) of one contact's pressure."""
    total = pressure.sum()
    if total == 0.0:
        return 0.0
    p = pressure / total
    x = x - p.sum(axis=1) @ x
    y = y - p.sum(axis=0) @ y
    return 5.0 * math.pi * math.sqrt((p.sum(axis=1) @ x**2) * (p.sum(axis=0) @ y**2) - (x @ p @ y) ** 2)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cell", type=float, default=0.006, help="side of the cells [mm]")
    parser.add_argument("--load", type=float, default=1.5, help="normal load [N]")
    parser.add_argument("--threads", type=int, default=2, help="threads of tamaas")
    given = parser.parse_args()
    tamaas.initialize(given.threads)
    surface, side = scene(given.cell)
    model = mf.BoundaryElements(given.cell)
    mf.equilibrium(surface, mf.BoundaryElements(4.0 * given.cell), load=given.load)
    seconds = math.inf
    for _ in range(REPEATS):
        begin = time.perf_counter()
        state = mf.equilibrium(surface, model, load=given.load)
        seconds = min(seconds, time.perf_counter() - begin)
    peer_seconds, peer_load, peer_area, peer_error = solve_with_tamaas(surface, given.cell, side, given.load)
    open_count = int((state.asperity_load == 0.0).sum())
    print(f"64 asperities, cell {given.cell:g} mm, {open_count} open; {state.notes[0]}")
    print(f"{'':10s}{'seconds':>10s}{'load [N]':>14s}{'area [mm^2]':>14s}{'residual':>11s}")
    print(f"{'metafem':10s}{seconds:10.2f}{state.load:14.8f}{state.area:14.8f}{state.residual:11.1e}")
    print(f"{'tamaas':10s}{peer_seconds:10.2f}{peer_load:14.8f}{peer_area:14.8f}{peer_error:11.1e}")
    print(f"{'':24s}{'wanted':>10s}{'measured':>10s}")
    print(f"{'seconds a load':24s}{WANTED_SECONDS:>9.0f}<{seconds:10.2f}")
    print(f"{'times faster':24s}{WANTED_RATIO:>9.0f}>{peer_seconds / seconds:10.1f}")
    print(f"{'area, relative':24s}{'':10s}{state.area / peer_area - 1.0:10.1e}")


if __name__ == "__main__":
    main()
