"""Errors of `Automatic(1e-3)` on random surfaces, and its time over that of order 3 in the same run."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor

import click
import numpy as np
from scipy.stats import linregress
from scipy.stats import t as student

import metafem as mf
from metafem.contact import Contact
from metafem.models.model import PARABOLOID
from validation.scenes.random_surfaces import random_surface
from validation.timing import Row, best

TOLERANCE = 1e-3

# Surfaces whose times are compared, and surfaces whose areas are compared with resolved contacts.
TIMED, COMPARED = 200, 100

# Cells of the reference: the largest contact radius over the first number, then smaller by the fourth root of
# 2 each, at least and at most so many sizes; and the probability that the area is within its uncertainty.
CELLS_PER_RADIUS, FEWEST, MOST = 24, 7, 13
CONFIDENCE = 0.95

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


def long_rows(count: int = COMPARED) -> list[Row]:
    """Compare the areas of surfaces with resolved contacts that are extrapolated to vanishing cells."""
    with ProcessPoolExecutor() as processes:
        return summary(list(processes.map(error_and_uncertainty, range(count))))


def summary(found: list[tuple[float, float]], start: int = 0) -> list[Row]:
    """Summarise errors and uncertainties of consecutive surfaces, from seed `start` on."""
    error, uncertainty = np.array(found).T
    certain = uncertainty <= TOLERANCE / 3.0
    largest = int(np.where(certain, error, -1.0).argmax())
    what = f"{certain.sum()} surfaces of 3 to 16 asperities"
    return [
        Row(f"{what}: largest error of A0, seed {start + largest}", TOLERANCE, float(error[largest]), ""),
        Row(f"{what}: errors above the tolerance", 0, float((error[certain] > TOLERANCE).sum()), ""),
        Row(f"{len(found)} surfaces: not converged", 0, float(np.isnan(error).sum()), ""),
        Row(
            f"{len(found)} surfaces: uncertain references",
            0,
            float((uncertainty > TOLERANCE / 3.0).sum()),
            "",
        ),
    ]


def error_and_uncertainty(seed: int, law: Contact = PARABOLOID) -> tuple[float, float]:
    """Relative error of A0 on a random surface, and uncertainty of the reference; nan without a solution."""
    surface, load = random_surface(seed)
    try:
        area = mf.equilibrium(surface, mf.Automatic(TOLERANCE, contact=law), load=load).area
    except mf.NotConverged:
        return np.nan, np.nan
    exact, uncertainty = reference(surface, load, law)
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


def reference(surface: mf.Surface, load: float, law: Contact) -> tuple[float, float]:
    """Return A0 [mm²] extrapolated from resolved contacts to vanishing cells, and its relative uncertainty.

    The mean error of the areas is proportional to the square of the cell. About it they scatter by some
    cells, as each cell at the edge of a contact is either open or closed. So A0 is fitted over the square of
    the cell by least squares, with errors proportional to that square. The cells become smaller until the
    confidence interval of the fit is within a third of the tolerance.
    """
    largest = mf.equilibrium(surface, mf.Independent(law), load=load).asperity_area.max()
    sizes = np.sqrt(largest / np.pi) / CELLS_PER_RADIUS * 2.0 ** (-0.25 * np.arange(MOST))
    areas: list[float] = []
    for cell in sizes:
        areas.append(mf.equilibrium(surface, mf.BoundaryElements(cell, contact=law), load=load).area)
        used = len(areas)
        if used >= FEWEST:
            # A0/cell² = slope/cell² + constant, with errors of one size
            fit = linregress(sizes[:used] ** -2.0, areas * sizes[:used] ** -2.0)
            half_width = student.ppf(0.5 + 0.5 * CONFIDENCE, used - 2) * fit.stderr
            if half_width <= TOLERANCE / 3.0 * fit.slope:
                break
    return float(fit.slope), float(half_width / fit.slope)


@click.command()
@click.argument("count", type=int)
@click.option("--start", default=0, help="First seed.")
@click.option("--processes", type=int, help="Default: one for each core.")
def main(count: int, start: int, processes: int | None) -> None:
    """Compare COUNT surfaces with resolved contacts; a thousand take about an hour of one core.

    Prints seed, relative error and uncertainty of the reference of each surface, then the summary.
    """
    found: list[tuple[float, float]] = []
    with ProcessPoolExecutor(processes) as pool:
        for pair in pool.map(error_and_uncertainty, range(start, start + count)):
            click.echo(f"{start + len(found)} {pair[0]:.3g} {pair[1]:.3g}")
            found.append(pair)
    for row in summary(found, start):
        click.echo(f"{row.what}: {row.measured:.3g}, at most {row.required:g}")


if __name__ == "__main__":
    main()
