"""Times of `Interacting`: one law, many laws, large lattices and scattered sites, and their growth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial

import numpy as np

import metafem as mf
import metafem.substrate
from metafem._kernels import continuation
from metafem.models.contact_tables import tables
from metafem.models.interacting.large import LargeScene
from validation.cost.scaling import LOAD_PER_ASPERITY, SUBSTRATES, lattice
from validation.scenes.costs import MATERIAL, heights, scattered
from validation.timing import Row, best, kernel_time, peak_memory, took

SURFACES, LOADS, ASPERITIES = 10_000, 20, 64
SIDES = (64, 256, 1000)

# Number of surfaces with new heights or sites.
NEW = 100

# FFT products of order 3, which expands in the displacement of the contacts, over those of order 1.
EXPANSION = 8

# Numbers of scattered asperities; the last one takes about a minute.
COUNTS, LARGEST = (10_000, 100_000), 1_000_000


def products(surface: mf.Surface, substrate: metafem.substrate.Radial, order: int) -> int:
    """Number of FFT products of one load, including those of the tangent stiffness."""
    scene = LargeScene(surface, substrate.for_surface(surface), order)
    results = continuation.Results(*np.zeros((len(continuation.Results._fields), 1)))
    load = np.array([LOAD_PER_ASPERITY * surface.count])
    law = tables(mf.Hertz(), surface.radius)
    scene.follow(law, np.zeros(surface.count), surface.gap, load, True, results)
    return scene.sums.products


def rows() -> Iterator[Row]:
    """Measure one law, many laws, large lattices and scattered asperities."""
    for name, substrate in SUBSTRATES.items():
        for order in (1, 3):
            model = mf.Interacting(order=order, substrate=substrate)
            seconds = kernel_time(model, lattice(8), 100)
            what = f"one load of a 100-load curve, 64 asperities, order {order}, {name}, one core"
            yield Row(what, 36.0, 1e6 * seconds, "µs")
        model, surface = mf.Interacting(substrate=substrate), lattice(8)
        seconds = best(lambda m=model, s=surface: mf.equilibrium(s, m, load=0.3), 50)
        what = f"one load alone, 64 asperities, order 3, {name}"
        yield Row(what, 200.0, 1e6 * seconds, "µs")
        for kind, allowed in (("heights", 200.0), ("sites", 400.0)):
            seconds = new_surface_time(model, kind)
            yield Row(
                f"one load, 64 asperities with new {kind}, order 3, {name}", allowed, 1e6 * seconds, "µs"
            )
    for side, allowed in ((20, 2.0), (40, 6.0), (100, 40.0)):
        seconds = curve_time(side) / LOADS
        what = f"one load of a {LOADS}-load curve, lattice of {side} x {side} on the layer, order 3"
        yield Row(what, allowed, 1e3 * seconds, "ms")
    height = heights((SURFACES, ASPERITIES))
    load = np.linspace(0.025, 0.5, LOADS)
    for name, substrate in SUBSTRATES.items():
        model = mf.Interacting(substrate=substrate)
        seconds = best(lambda model=model: model.curves(lattice(8), height, load), 1)
        what = f"10,000 curves of 20 loads, 64 asperities, order 3, {name}, two cores"
        yield Row(what, 10.0, seconds, "s")
    for name, products_allowed in (("layer", 40), ("half-space", 45)):
        substrate = SUBSTRATES[name]
        for side in SIDES:
            count = products(lattice(side), substrate, 1)
            what = f"lattice of {side} x {side}, one load, order 1, {name}: FFT products"
            yield Row(what, products_allowed, count)
        count = products(lattice(SIDES[1]), substrate, 3)
        what = f"lattice of {SIDES[1]} x {SIDES[1]}, one load, order 3, {name}: FFT products"
        yield Row(what, EXPANSION * products_allowed, count)
    yield Row(f"memory after the lattice of {SIDES[-1]} x {SIDES[-1]}", 3.0, peak_memory(), "GiB")
    for name, substrate in SUBSTRATES.items():
        few, many = (scattered_time(count, substrate) for count in COUNTS)
        what = f"{COUNTS[1]} scattered asperities, one load, order 1, {name}"
        yield Row(what, 30.0, many, "s")
        yield growth(name, COUNTS, (few, many))


def new_surface_time(model: mf.Interacting, kind: str) -> float:
    """Least seconds of one load of surfaces with other heights or sites than before."""
    rng, surface = np.random.default_rng(0), lattice(8)
    seconds = []
    for height in heights((NEW, surface.count)):
        change = {"height": height}
        if kind == "sites":
            change["position"] = surface.position + rng.uniform(-0.1, 0.1, surface.position.shape)
        seconds.append(took(partial(mf.equilibrium, surface.replaced(**change), model, load=0.3))[0])
    return min(seconds)


def curve_time(side: int) -> float:
    """Least seconds of a curve of order 3 for other heights on a lattice on the layer."""
    model, surface = mf.Interacting(substrate=SUBSTRATES["layer"]), lattice(side)
    load = np.linspace(0.1, 2.0, LOADS) * LOAD_PER_ASPERITY * surface.count
    changed = (surface.replaced(height=height) for height in heights((3, surface.count)))
    return min(took(partial(model.curve, each, load))[0] for each in changed)


def long_rows() -> list[Row]:
    """Measure the time and the memory of the largest number of scattered asperities, and the growth."""
    rows = []
    for name, substrate in SUBSTRATES.items():
        seconds = [scattered_time(count, substrate) for count in (COUNTS[0], LARGEST)]
        what = f"{LARGEST} scattered asperities, one load, order 1, {name}"
        rows += [Row(what, 60.0, seconds[1], "s"), growth(name, (COUNTS[0], LARGEST), seconds)]
    return [*rows, Row(f"memory after {LARGEST} scattered asperities", 3.0, peak_memory(), "GiB")]


def scattered_time(count: int, substrate: metafem.substrate.Radial) -> float:
    """Seconds of one load of scattered asperities, after a small surface that is not timed."""
    model = mf.Interacting(order=1, substrate=substrate)
    for size in (COUNTS[0] // 2, count):
        surface = scattered(size)
        load = LOAD_PER_ASPERITY * size * MATERIAL.composite_modulus
        seconds, _ = took(partial(mf.equilibrium, surface, model, load=load))
    return seconds


def growth(name: str, counts: Sequence[int], seconds: Sequence[float]) -> Row:
    """Return the row of the exponent of the time between two counts."""
    exponent = np.log(seconds[1] / seconds[0]) / np.log(counts[1] / counts[0])
    return Row(f"growth of the time from {counts[0]} to {counts[1]}, exponent, {name}", 1.15, exponent)
