"""Laws between two curves: designs with a margin, and corrections of surfaces made with errors."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

import metafem as mf
from metafem.drawing import ACHIEVED, QUIET, TARGET
from validation.check import Claim, Picture, Row, above, below, reported
from validation.figures import panels
from validation.methods import independent
from validation.scenes.bands import ERROR, WIDTH, scene
from validation.scenes.random_laws import RADIUS
from validation.sources import known_input, second_method

# Number of surfaces with errors.
TRIALS = 20

KNOWN = known_input("a surface with a law in the middle of the band exists")
AREAS = second_method(independent.areas, "law of the corrected heights, by bisection")


@cache
def corrected(seed: int) -> tuple[mf.Surface, mf.Band, mf.Surface]:
    """Return a surface with errors, the band around its intended law, and the corrected surface."""
    _, made, band = scene(seed)
    change = mf.brought_into(made, band).change
    return made, band, made.replaced(height=made.height + change)


def excess(surface: mf.Surface, band: mf.Band) -> float:
    """Return the largest relative distance of the law of a surface from its band, 0 inside."""
    area = independent.areas(surface.height, band.rescaled_load, RADIUS)
    return float(np.maximum(area / band.highest - 1.0, 1.0 - area / band.lowest).max().clip(0.0))


def claim() -> Claim:
    """A band accepts any law between two curves. Surfaces made with random errors are brought back into bands
    around their intended laws by small changes of the heights. The laws of the corrected heights are computed
    a second time with numpy.
    """
    values = {"width": f"{WIDTH:.1%}", "error": f"{1e3 * ERROR:g} µm"}
    return Claim("Bands", list(_rows()), {"A surface brought into a band": Picture(_figure, values)})


def _rows() -> Iterator[Row]:
    before, after, ratios = [], [], []
    for seed in range(TRIALS):
        known, made, band = scene(seed)
        _, _, right = corrected(seed)
        before.append(excess(made, band))
        after.append(excess(right, band))
        ratios.append(np.linalg.norm(right.height - made.height) / np.linalg.norm(known.height - made.height))
    yield reported(
        f"{TRIALS} surfaces with errors: largest distance from the band",
        max(before),
        "law of the heights as made",
    )
    yield above(
        f"{TRIALS} surfaces with errors: number brought into the band",
        sum(e < 1e-9 for e in after),
        TRIALS,
        KNOWN,
    )
    yield below("largest distance from the band after the correction", max(after), 1e-9, AREAS)
    yield below(
        "changes of the heights over their errors, largest ratio of the norms", max(ratios), 1.0, KNOWN
    )


@panels(6.0, 3.4)
def _figure(ax):
    """Law of the surface farthest from its band, with errors of {error}, relative to the middle of the band
    of ± {width} (red), before and after the correction of its heights.
    """
    cases = [corrected(seed) for seed in range(TRIALS)]
    made, band, right = max(cases, key=lambda case: excess(*case[:2]))
    middle = 0.5 * (band.lowest + band.highest)
    ax.fill_between(
        band.rescaled_load,
        100 * (band.lowest / middle - 1),
        100 * (band.highest / middle - 1),
        color=TARGET,
        alpha=0.3,
        lw=0,
    )
    for surface, colour, label in ((made, QUIET, "as made"), (right, ACHIEVED, "corrected")):
        area = independent.areas(surface.height, band.rescaled_load, RADIUS)
        ax.plot(band.rescaled_load, 100 * (area / middle - 1.0), "o-", ms=3, color=colour, label=label)
    ax.set_xlabel("rescaled load  P/E* [mm²]")
    ax.set_ylabel("difference from the middle [%]")
    ax.legend(frameon=False)
