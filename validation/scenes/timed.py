"""What is timed in several commits, by a process for each that runs this file: it needs the package alone."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterable
from functools import cache
from typing import Any

import numpy as np

import metafem as mf

MATERIAL, BLOCK = mf.Material(1.36, 0.5), mf.Block(1000.0, 1000.0, 7.2)

# Rescaled load per asperity [mm²] at the end of a curve, whose plane touches two thirds of them.
LOAD_PER_ASPERITY = 0.003

# Number of curves and of cold states of which the quickest counts, of surfaces of a batch, and of those that
# are solved one at a time.
CURVES, STATES, BATCH, SINGLE = 30, 300, 1000, 50


def quickest(works: Iterable[Callable[[], Any]]) -> float:
    """Return the seconds of the quickest of some works, after the first one."""
    first, *others = works
    first()
    seconds = []
    for work in others:
        start = time.perf_counter()
        work()
        seconds.append(time.perf_counter() - start)
    return min(seconds)


@cache
def heights(rows: int, count: int) -> np.ndarray:
    """Return lists of exponential heights [mm]."""
    return 0.05 + np.random.default_rng(0).exponential(0.03, (rows, count))


def lattice(side: int, pitch: float = 1.5) -> mf.Surface:
    """Return a square lattice."""
    height = heights(1, side**2)[0]
    return mf.Surface.square_lattice(
        height, (side, side), pitch, radius=0.526, material=MATERIAL, block=BLOCK
    )


def loads(count: int, number: int) -> np.ndarray:
    """Return increasing rescaled loads [mm²]."""
    return LOAD_PER_ASPERITY * count * np.arange(1, number + 1) / number


def curve(model: Any, surface: mf.Surface, number: int, runs: int = CURVES) -> float:
    """Return the seconds of each load of a curve."""
    load = loads(surface.count, number)
    return quickest([lambda: model.curve(surface, load).checked()] * runs) / number


def order_3() -> float:
    """Each of 100 loads of order 3."""
    return curve(mf.Interacting(), lattice(8), 100)


def new_heights() -> float:
    """One load on heights that are new each time."""
    return _cold([lattice(8).replaced(height=row) for row in heights(STATES, 64)])


def new_sites() -> float:
    """One load on sites that are new each time."""
    rng, square = np.random.default_rng(1), lattice(8)
    shift = rng.uniform(-0.1, 0.1, (STATES, 64, 2))
    return _cold([square.replaced(position=square.position + each) for each in shift])


def _cold(surfaces: list[mf.Surface]) -> float:
    load = float(MATERIAL.composite_modulus * loads(64, 1)[0])
    return quickest(
        [lambda each=each: mf.equilibrium(each, mf.Interacting(), load=load) for each in surfaces]
    )


def batch() -> float:
    """Each of 1,000 surfaces under 25 loads."""
    surface, load = lattice(8), loads(64, 25)
    return quickest([lambda: mf.Interacting().areas(surface, load, heights(BATCH, 64))] * 4) / BATCH


def single() -> float:
    """The same, one surface at a time: the seconds of the quickest round of 50, over 50."""
    load = MATERIAL.composite_modulus * loads(64, 25)
    surfaces = [lattice(8).replaced(height=row) for row in heights(SINGLE, 64)]
    laws = [lambda: [mf.friction_law(each, mf.Interacting(), load=load) for each in surfaces]]
    return quickest(laws * 6) / SINGLE


def automatic(pitch: float, model: Any = None) -> float:
    """A law of 100 loads by `Automatic` on a sparse lattice, or by another model."""
    surface, load = lattice(8, pitch), MATERIAL.composite_modulus * loads(64, 100)
    chosen = mf.Automatic(1e-3) if model is None else model
    return quickest([lambda: mf.friction_law(surface, chosen, load=load)] * CURVES)


def independent(pitch: float) -> float:
    """The same by independent asperities."""
    return automatic(pitch, mf.Independent())


def layer(side: float) -> float:
    """Each of 20 loads of order 3 on a layer."""
    model = mf.Interacting(substrate=mf.BondedLayer())
    return curve(model, lattice(int(side)), 20, 8 if side < 100 else 3)


if __name__ == "__main__":
    for work in sys.argv[1:]:
        name, *numbers = work.split()
        print(globals()[name](*map(float, numbers)))
