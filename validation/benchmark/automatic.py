"""Errors of `Automatic(1e-3)` on random surfaces, and its time over that of order 3 in the same run."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor

import click
import numpy as np

import metafem as mf
from metafem.contact import Contact
from metafem.models.model import PARABOLOID
from validation.methods.resolved_areas import extrapolated_area
from validation.scenes.random_contacts import scattered
from validation.timing import Row, best

TOLERANCE = 1e-3

# Surfaces whose times are compared, and surfaces whose areas are compared with resolved contacts.
TIMED, COMPARED = 200, 100

# Loads of a law.
LOADS = 30

# Ranges of the mean distance and of the smallest distance of two sites [mm], of which the nearest contacts
# merge, and of the rescaled load P/E* of each asperity [mm²].
SPACING, CLOSEST, LOAD = (0.4, 1.5), (0.1, 0.4), (5e-4, 2e-2)


def random_surface(seed: int) -> tuple[mf.Surface, float]:
    """Return a surface of 3 to 16 asperities and a load [N]."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 17))
    closest = rng.uniform(*CLOSEST)
    position = scattered(rng, count, closest, rng.uniform(*SPACING) * np.sqrt(count))
    height = 0.1 + rng.exponential(0.03, count)
    load = count * float(np.exp(rng.uniform(*np.log(LOAD))))
    material = mf.Material(1.36)
    return mf.Surface(position, height, 0.526, material), load * material.composite_modulus


def rows() -> list[Row]:
    """Compare the times of surfaces for which an asperity model suffices."""
    ratios = np.array([ratio for seed in range(TIMED) if (ratio := time_ratios(seed))])
    one, law = np.median(ratios, axis=0)
    what = f"median time over that of order 3, {len(ratios)} surfaces"
    return [Row(f"{what}, one load", 1.1, one), Row(f"{what}, each of {LOADS} loads", 1.1, law)]


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
        Row(f"{what}: largest error of A0, seed {start + largest}", TOLERANCE, error[largest]),
        Row(f"{what}: errors above the tolerance", 0, (error[certain] > TOLERANCE).sum()),
        Row(f"{len(found)} surfaces: not converged", 0, np.isnan(error).sum()),
        Row(f"{len(found)} surfaces: uncertain references", 0, (uncertainty > TOLERANCE / 3.0).sum()),
    ]


def error_and_uncertainty(seed: int, law: Contact = PARABOLOID) -> tuple[float, float]:
    """Relative error of A0 on a random surface, and uncertainty of the reference; nan without a solution."""
    surface, load = random_surface(seed)
    try:
        area = mf.equilibrium(surface, mf.Automatic(TOLERANCE, contact=law), load=load).area
    except mf.NotConverged:
        return np.nan, np.nan
    exact, uncertainty = extrapolated_area(surface, load, TOLERANCE / 3.0, law)
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
