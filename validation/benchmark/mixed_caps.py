"""Times of caps that differ against those of one cap, in runs that follow each other.

All scenes have the same sites, heights and radii. In the first one all caps are `Power(4)`, in the last one
the four tools of `TOOLS` are mixed at random, and those between have one of the tools each. All are pressed
by `Elastic()`. The kernel computes loads, areas and their derivatives at given indentations. Curves are
computed at the loads of independent asperities at common approaches; the number of steps of their solvers
depends on the shapes. The ratios are medians over the runs, so that other work of the machine has little
effect.

Run ``python -m validation.benchmark mixed_caps``.
"""

from __future__ import annotations

import statistics
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

import metafem as mf
from metafem._kernels.contact import independent as kernel
from metafem.models.contact_tables import tables
from validation.timing import Row, took

PITCH, MATERIAL = 1.5, mf.Material(1.36)
BLOCK = mf.Block(400.0, 400.0, 7.2)
OWN = mf.Elastic()


def bowl(rho: np.ndarray) -> np.ndarray:
    """Return the profile of the fourth tool [mm]."""
    return np.asarray(rho**2 / 1.1 + 0.4 * rho**4)


TOOLS = (mf.Sphere(), mf.Power(4.0), mf.Power(1.7, 0.4), mf.Profile(bowl, 0.6))

# Asperities along a side: approaches [mm], and number of runs.
SCENES = {20: (np.linspace(0.004, 0.03, 20), 15), 100: (np.linspace(0.01, 0.03, 4), 3)}

# Largest ratio of the curves of independent asperities: the first guess of their solver is exact only if all
# caps have one power law.
LARGEST_ALONE = 1.2

# Largest ratio of all other times, number of runs of the kernel, and its approaches [mm].
LARGEST, RUNS, DEPTHS = 1.1, 100, np.linspace(0.01, 0.02, 5)


def scenes(side: int) -> list[mf.Surface]:
    """Return lattices with one power cap, with each tool alone, and with all tools."""
    rng = np.random.default_rng(0)
    count = side**2
    height, kind = 0.1 + 0.02 * rng.random(count), rng.integers(0, len(TOOLS), count)
    plain = mf.Surface.square_lattice(
        height, (side, side), PITCH, radius=0.526, material=MATERIAL, block=BLOCK
    )
    alone = [plain.replaced(cap=cap) for cap in (mf.Power(4.0), *TOOLS)]
    return [*alone, plain.replaced(cap=[TOOLS[k] for k in kind])]


def ratios(actions: list[Callable[[], object]], runs: int) -> tuple[float, float, float]:
    """Return medians of the time of the last action over the first, and over the mean of those between.

    The third number is the median of the last time [s]. All actions run once before.
    """
    for action in actions:
        action()
    found = [[took(action)[0] for action in actions] for _ in range(runs)]
    first = statistics.median(row[-1] / row[0] for row in found)
    mean = statistics.median(row[-1] / statistics.fmean(row[1:-1]) for row in found)
    return first, mean, statistics.median(row[-1] for row in found)


def evaluations(surface: mf.Surface) -> Callable[[], object]:
    """Return a function that evaluates the contacts of a surface at `DEPTHS` by the kernel."""
    law = OWN.bound(surface)
    depth = DEPTHS[:, None] - surface.gap
    return partial(kernel.each, tables(law, law.summits(surface)), depth, *np.empty((4, *depth.shape)))


def curve(model: mf.Independent | mf.Interacting, surface: mf.Surface, load: np.ndarray) -> object:
    """Return the curve of a surface."""
    return model.curve(surface, load).checked()


def rows() -> Iterator[Row]:
    """Measure the times of four tools over those of one cap."""
    own = mf.Independent(OWN)
    coupled = [
        mf.Interacting(order, substrate, OWN)
        for substrate in (mf.HalfSpace(), mf.BondedLayer())
        for order in (1, 3)
    ]
    for side, (approach, runs) in SCENES.items():
        parts = scenes(side)
        name = f"{side**2} asperities"
        first, mean, _ = ratios([evaluations(part) for part in parts], RUNS)
        yield Row(f"kernel, {name}: four tools over Power(4)", LARGEST, first)
        yield Row(f"kernel, {name}: four tools over the mean of each alone", LARGEST, mean)
        loads = [own.curve(part, approach=approach).load for part in parts]
        for model in (own, *coupled):
            pairs = zip(parts, loads, strict=True)
            first, _, last = ratios([partial(curve, model, *pair) for pair in pairs], runs)
            largest = LARGEST if model.couples else LARGEST_ALONE
            yield Row(f"{name}, {model.name}: four tools over Power(4)", largest, first)
            yield Row(f"{name}, {model.name}: {len(approach)} loads of four tools", 60.0, last, "s")
