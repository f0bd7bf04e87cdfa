"""Errors of `Automatic(1e-3)` on random surfaces, and its time over that of order 3 in the same run."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor

import click
import numpy as np

import metafem as mf
from validation.scenes.random_surfaces import random_surface
from validation.timing import Row, best

TOLERANCE = 1e-3

# Surfaces whose times are compared, and surfaces whose areas are compared with resolved contacts.
TIMED, COMPARED = 200, 100

# Cells of the reference: the largest contact radius over the first number, then smaller by the square root of
# 2, at most so many times.
CELLS_PER_RADIUS, MOST_REFINED = 12, 6

# Loads of a law.
LOADS = 30


def rows() -> list[Row]:
    """Compare the times of surfaces for which an asperity model suffices."""
    ratios = np.array([ratio for seed in range(TIMED) if (ratio := time_ratios(seed))])
    one, law = np.median(ratios, axis=0)
    what = f"median time over that of order 3, {len(ratios)} surfaces"
    return [
        Row(f"{what}, one load", 1.1, float(one), ""),
        Row(f"{what}, each of {LOADS} loads", 1.1, float(law), ""),
    ]


def long_rows(count: int = COMPARED, start: int = 0) -> list[Row]:
    """Compare the areas of surfaces with resolved contacts that are extrapolated to vanishing cells."""
    with ProcessPoolExecutor() as processes:
        found = np.array(list(processes.map(error_and_uncertainty, range(start, start + count))))
    error, uncertainty = found.T
    certain = uncertainty <= TOLERANCE / 3.0
    largest = int(np.where(certain, error, -1.0).argmax())
    what = f"{certain.sum()} surfaces of 3 to 16 asperities"
    return [
        Row(f"{what}: largest error of A0, seed {start + largest}", TOLERANCE, float(error[largest]), ""),
        Row(f"{what}: errors above the tolerance", 0, float((error[certain] > TOLERANCE).sum()), ""),
        Row(f"{count} surfaces: not converged", 0, float(np.isnan(error).sum()), ""),
        Row(
            f"{count} surfaces: uncertain references", count, float((uncertainty > TOLERANCE / 3.0).sum()), ""
        ),
    ]


def error_and_uncertainty(seed: int) -> tuple[float, float]:
    """Relative error of A0 on a random surface, and uncertainty of the reference; nan without a solution."""
    surface, load = random_surface(seed)
    try:
        area = mf.equilibrium(surface, mf.Automatic(TOLERANCE), load=load).area
    except mf.NotConverged:
        return np.nan, np.nan
    exact, uncertainty = reference(surface, load)
    return abs(area / exact - 1.0), uncertainty


def time_ratios(seed: int) -> tuple[float, float] | None:
    """Times of one load and of a law over those of order 3, or None where contacts are resolved."""
    surface, load = random_surface(seed)
    model = mf.Automatic(TOLERANCE)
    if isinstance(mf.equilibrium(surface, model, load=load).model, mf.BoundaryElements):
        return None
    loads = load * np.arange(1, LOADS + 1) / LOADS
    models = (model, mf.Interacting())
    # a copy of the surface keeps no influence of the run before
    one = [best(lambda m=m: mf.equilibrium(surface.replaced(), m, load=load), 5) for m in models]
    law = [best(lambda m=m: mf.friction_law(surface.replaced(), m, load=loads), 3) for m in models]
    return one[0] / one[1], law[0] / law[1]


def reference(surface: mf.Surface, load: float) -> tuple[float, float]:
    """Return A0 [mm²] extrapolated from the cells, and the larger of its last two relative changes."""
    largest = mf.equilibrium(surface, load=load).asperity_area.max()
    cell = np.sqrt(largest / np.pi) / CELLS_PER_RADIUS
    areas: list[float] = []
    for refined in range(MOST_REFINED + 1):
        model = mf.BoundaryElements(cell * 2.0 ** (-0.5 * refined))
        areas.append(mf.equilibrium(surface, model, load=load).area)
        # the error falls as the square of the cell
        limits = 2.0 * np.array(areas[1:]) - areas[:-1]
        changes = np.abs(limits[1:] / limits[:-1] - 1.0)
        if refined > 2 and changes[-2:].max() <= TOLERANCE / 3.0:
            break
    return float(limits[-1]), float(changes[-2:].max())


@click.command()
@click.argument("count", type=int)
@click.option("--start", default=0, help="First seed.")
def main(count: int, start: int) -> None:
    """Compare COUNT surfaces with resolved contacts, on all cores; a thousand take about an hour on two."""
    for row in long_rows(count, start):
        click.echo(f"{row.what}: {row.measured:.3g}, at most {row.required:g}")


if __name__ == "__main__":
    main()
