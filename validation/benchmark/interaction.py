"""Times of interacting models: single laws, many laws, large lattices and scattered positions."""

from __future__ import annotations

import numpy as np

import metafem as mf
from metafem._kernels import continuation
from validation.benchmark.timing import Row, best

SURFACES, LOADS, ASPERITIES = 10_000, 20, 64
MATERIAL = mf.Material(1.36)
BLOCK = mf.Block(20.0, 20.0, 7.2)
SUBSTRATES = {"half-space": mf.HalfSpace(), "layer": mf.BondedLayer()}


def heights(shape: int | tuple[int, ...]) -> np.ndarray:
    """Exponential heights of scale 0.036 mm, cut at 0.12 mm, tallest first in density."""
    return 0.12 - np.minimum(np.random.default_rng(0).exponential(0.036, shape), 0.12)


def small() -> mf.Surface:
    """The paper's lattice."""
    return mf.Surface.square_lattice(heights(ASPERITIES), radius=0.526, material=MATERIAL, block=BLOCK)


def kernel_time(model: mf.Interacting, surface: mf.Surface, loads: int) -> float:
    """Seconds per load of one warm curve inside the compiled kernel, on one core."""
    coupling, own = model._coupling(surface)
    results = continuation.empty_results(1, loads)
    place = continuation.empty_workplace(surface.count, model.order)
    rising = np.linspace(0.5 / loads, 0.5, loads)
    radius, gap = np.array(surface.radius[None]), surface.gap[None]
    arguments = (coupling, model.order, radius, own[None], gap, rising, True, results, *place)
    return best(lambda: continuation.curves(*arguments), 20) / loads


def rows() -> list[Row]:
    """Measure every row of the second part's table that is a time of an asperity model."""
    measured = []
    for name, substrate in SUBSTRATES.items():
        for order in (1, 3):
            model = mf.Interacting(order=order, substrate=substrate)
            seconds = kernel_time(model, small(), 100)
            what = f"one load of a 100-load curve, 64 asperities, order {order}, {name}, one core"
            measured.append(Row(what, 50.0, 1e6 * seconds, "µs"))
    height = heights((SURFACES, ASPERITIES))
    load = np.linspace(0.025, 0.5, LOADS)
    for name, substrate in SUBSTRATES.items():
        model = mf.Interacting(substrate=substrate)
        seconds = best(lambda model=model: model.curves(small(), height, load), 1)
        what = f"10,000 curves of 20 loads, 64 asperities, order 3, {name}, two cores"
        measured.append(Row(what, 10.0, seconds, "s"))
    return measured
