"""Seconds of laws by model and number of asperities, of designs, of a drag and of the first command."""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

import metafem as mf
from validation.cost.points import MATERIAL, heights, scattered
from validation.scenes.browser import browser_path, opened
from validation.scenes.explorer import latencies, served, visited
from validation.timing import Row, spent, took

LAYER = mf.Interacting(substrate=mf.BondedLayer(7.2))

# Rescaled load per asperity [mm²] of a law, whose plane touches two thirds of them, and the loads of a curve.
LOAD_PER_ASPERITY, LOADS = 0.003, 20

# Runs after the first one, of which the quickest counts.
REPEATS = 3


class Speed(NamedTuple):
    """What is timed, its work, which is told the number of the run, and the seconds of a later run."""

    what: str
    work: Callable[[int], object]
    allowed: float


# Models and the largest seconds of one load, and of a curve of 20 loads, by the number of asperities.
MODELS: dict[str, tuple[mf.models.Model, dict[int, tuple[float, float]]]] = {
    "independent": (mf.Independent(), {64: (5e-4, 1e-3), 10_000: (0.05, 0.5)}),
    "order 3": (mf.Interacting(), {64: (1e-3, 2e-3), 400: (0.02, 0.05), 1600: (0.4, 1.0)}),
    "order 3, layer": (LAYER, {64: (1e-3, 2e-3), 400: (0.02, 0.05), 1600: (0.4, 1.0)}),
    "order 1": (mf.Interacting(order=1), {10_000: (3.0, 20.0)}),
    "automatic": (mf.Automatic(), {64: (5e-3, 0.05)}),
    "resolved, cells of 20 µm": (mf.BoundaryElements(0.02), {16: (3.0, 60.0)}),
}

# Largest seconds of a design by the number of asperities; that of each target.
DESIGNS = {64: 0.3, 400: 5.0}

# Largest 95th percentile from a drag of a point to the law on the screen, and of the first command [s].
DRAG, FIRST = 0.06, 20.0
MOVES, REACH = 60, 10.0  # [pixels]


def rows() -> Iterator[Row]:
    """Time everything once, with what it compiles or reads, and then again on other heights."""
    for each in (*laws(), *designs()):
        first, *later = (took(partial(each.work, run))[0] for run in range(1 + REPEATS))
        yield Row(f"{each.what}: first", float("inf"), first, "s")
        yield Row(f"{each.what}: again", each.allowed, min(later), "s")
    yield from first_command()
    yield from drags()


def laws() -> Iterator[Speed]:
    """Yield one load and a curve of each model."""
    for name, (model, sizes) in MODELS.items():
        for count, (one, curve) in sizes.items():
            load = LOAD_PER_ASPERITY * count * np.arange(1, LOADS + 1) / LOADS
            for loads, allowed in ((load[-1:], one), (load, curve)):
                what = f"{name}, {count:,} asperities, {len(loads)} load{'s' if len(loads) > 1 else ''}"
                yield Speed(what, partial(_law, model, count, loads), allowed)


def _law(model: mf.models.Model, count: int, load: np.ndarray, run: int) -> mf.models.Curve:
    """Solve loads of a model on scattered sites, or on a lattice where it is resolved."""
    return model.curve(_surfaces(count)[run], load).checked()


@cache
def _surfaces(count: int) -> list[mf.Surface]:
    """Return as many surfaces as there are runs."""
    kept = heights((1 + REPEATS, count))
    return [scattered(count).replaced(height=height) for height in kept]


def designs() -> Iterator[Speed]:
    """Yield designs of each kind of target, whose loads and areas grow with the number of asperities."""
    for count, allowed in DESIGNS.items():
        for kind, (target, limits) in tasks(count).items():
            for name, model in (("independent", mf.Independent()), ("layer", LAYER)):
                work = partial(_design, target, count, model, limits)
                yield Speed(f"design, {kind}, {count} asperities, {name}", work, allowed)


def tasks(count: int) -> dict[str, tuple[mf.inversion.Target, mf.Limits]]:
    """Return targets and limits by name; the loads of the paper's lattice are scaled from 64 asperities."""
    scale = count / 64
    thick, free = mf.Limits(0.27), mf.Limits(0.3, offset=0.05)
    height, load = np.random.default_rng(0).exponential(0.03, count), np.linspace(0.02, 0.5, 30) * scale
    area = mf.Independent().areas(_template(count), load, height[None])[0]
    points = np.array([0.144, 0.336, 0.649]) * scale, np.array([0.84, 1.68, 4.12]) * scale
    return {
        "line": (mf.LinearLaw(6.87), mf.Limits(0.12, offset=0.084)),
        "line over a range": (mf.LinearLaw(6.87, load_range=(0.05 * scale, 0.4 * scale)), free),
        "two slopes": (mf.BilinearLaw((7.15, 12.52), 0.038 * scale), mf.Limits(0.12, offset=0.05)),
        "three points": (mf.OperatingPoints(*points), thick),
        "power": (mf.PowerLaw(0.8, (0.1 * scale, 0.4 * scale)), free),
        "30 samples": (mf.SampledLaw(load, area), free),
        "band": (mf.Band(load, 0.98 * area, 1.02 * area), free),
    }


@cache
def _template(count: int) -> mf.Surface:
    side = round(count**0.5)
    return mf.Surface.square_lattice(0.12, (side, side), 1.5, radius=0.526, material=MATERIAL)


def _design(
    target: mf.inversion.Target, count: int, model: mf.models.Model, limits: mf.Limits, run: int
) -> mf.Design:
    return mf.design(target, _template(count), model, limits, rng=run)


def first_command() -> Iterator[Row]:
    """Run the demo in a process of its own, twice: the first run may compile kernels."""
    with tempfile.TemporaryDirectory() as folder:
        for name, allowed in (("first", float("inf")), ("again", FIRST)):
            command = [sys.executable, "-m", "metafem", "demo", "linear", "--force"]
            seconds, memory = spent(command, cwd=folder)
            yield Row(f"metafem demo linear: {name}", allowed, seconds, "s")
        yield Row("its peak memory", 1.0, memory, "GiB")
        yield Row("size of its report", 3.0, Path(folder, "linear/report.html").stat().st_size / 1e6, "MB")


def drags() -> Iterator[Row]:
    """Start the explorer and drag the points of its law, where a browser is installed."""
    if browser_path() is None:
        return
    with opened() as browser, served() as server, visited(browser, server) as visit:
        yield Row("explorer: from the command to the first law", 8.0, server.seconds + visit.seconds, "s")
        rng, times = np.random.default_rng(0), []
        for handle in visit.handles():
            latencies(visit, handle, [(3.0, 3.0), (0.0, 0.0)])
            moves = rng.uniform(-REACH, REACH, (MOVES, 2)).tolist()
            times += latencies(visit, handle, [(right, down) for right, down in moves])
        for percent in (50, 95):
            what = f"explorer: from a drag to the law, percentile {percent}"
            yield Row(what, DRAG, 1e-3 * float(np.percentile(times, percent)), "s")
