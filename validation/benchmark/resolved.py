"""Time of one load of resolved contacts, and its ratio to that of tamaas with the same cells.

The surface has 8 x 8 asperities on a half-space. Both use the same grid: tamaas all of it, metafem the
neighbourhoods of the contacts. tamaas is installed by the extra ``[peers]`` (AGPL-3.0; metafem does not
import it); without it only the time of metafem is measured. With cells of 6 µm tamaas takes minutes and runs
with ``--long`` only. ``python -m validation.benchmark.resolved`` also prints the loads and areas of both.
"""

from __future__ import annotations

import importlib.util
import math
from dataclasses import dataclass

import click
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


@dataclass(frozen=True)
class Answer:
    """One solver's seconds, load [N], area by moments [mm^2], and error or its bound."""

    seconds: float
    load: float
    area: float
    error: float


def scene() -> mf.Surface:
    """Return the surface, whose asperities are all in contact under `LOAD`."""
    quantile = (np.arange(64) + 0.5) / 64
    height = OFFSET - SCALE * np.log1p(quantile * math.expm1(-MAX_HEIGHT / SCALE))
    height = np.random.default_rng(1).permutation(height)
    return mf.Surface.square_lattice(height, (8, 8), PITCH, radius=RADIUS, material=mf.Material(MODULUS))


def solve(surface: mf.Surface, cell: float) -> Answer:
    """Answer of metafem: the fastest of three runs, compilation excluded."""
    model = mf.BoundaryElements(cell)
    seconds = best(lambda: mf.equilibrium(surface, model, load=LOAD), 3)
    state = mf.equilibrium(surface, model, load=LOAD)
    return Answer(seconds, state.load, state.area, state.residual)


def solve_with_tamaas(surface: mf.Surface, cell: float) -> Answer:
    """Answer of tamaas on its grid, with the area by second moments."""
    peer = peers.solve_with_tamaas(peers.Grid(surface, cell), LOAD, tolerance=PEER_TOLERANCE)
    return Answer(peer.seconds, peer.load, peer.moments, PEER_TOLERANCE)


def rows() -> list[Row]:
    """Measure the time of one load, and compare with tamaas at coarse cells."""
    metafem = solve(scene(), CELL)
    measured = [Row(f"one load, 64 resolved asperities, cell {1e3 * CELL:g} µm", 10.0, metafem.seconds, "s")]
    return measured + _compared_with_tamaas(QUICK_CELL)


def long_rows() -> list[Row]:
    """Compare with tamaas at fine cells."""
    return _compared_with_tamaas(CELL)


def _compared_with_tamaas(cell: float) -> list[Row]:
    """Compare times and areas at one size of the cells, if tamaas is installed."""
    if importlib.util.find_spec("tamaas") is None:
        return []
    surface = scene()
    metafem, peer = solve(surface, cell), solve_with_tamaas(surface, cell)
    # within the looser tolerance of tamaas
    difference = abs(metafem.area / peer.area - 1.0)
    name = f"cell {1e3 * cell:g} µm"
    return [
        Row(f"time over that of tamaas in the same run, {name}", 0.1, metafem.seconds / peer.seconds, ""),
        Row(f"relative difference of the areas from tamaas, {name}", 10.0 * PEER_TOLERANCE, difference, ""),
    ]


@click.command()
@click.option("--cell", default=CELL, show_default=True, help="Side of the cells [mm].")
def main(cell: float) -> None:
    """Print the time, load, area and error of both solvers."""
    surface = scene()
    metafem, peer = solve(surface, cell), solve_with_tamaas(surface, cell)
    click.echo(f"{'':8s}{'seconds':>10s}{'load [N]':>14s}{'area [mm^2]':>14s}{'error':>10s}")
    for name, answer in (("metafem", metafem), ("tamaas", peer)):
        numbers = f"{answer.seconds:10.2f}{answer.load:14.8f}{answer.area:14.8f}{answer.error:10.1e}"
        click.echo(f"{name:8s}{numbers}")
    click.echo(f"seconds for one load: required below 10, measured {metafem.seconds:.2f}")
    click.echo(
        f"time of tamaas over that of metafem: required 10, measured {peer.seconds / metafem.seconds:.1f}"
    )


if __name__ == "__main__":
    main()
