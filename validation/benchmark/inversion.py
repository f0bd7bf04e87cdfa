"""Times and misfits of inversions of all kinds of target under every model, and of arrangements."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np

import metafem as mf
from validation.scenes.models import MODELS
from validation.scenes.random_laws import LATTICE, LIMITS, RADIUS, mixed_law, random_law
from validation.timing import Row, best, peak_memory, took

# Numbers of random laws, for each model and in all.
RANDOM_LAWS = 516
ALL_LAWS = RANDOM_LAWS * len(MODELS)

# Laws of surfaces with several radii, and the tool radii [mm].
MIXED_LAWS, TOOLS = 100, [0.1, 0.4, 1.6]

# Rows of the lattices that are arranged; the last one takes minutes.
SIDES, LARGEST = (8, 32), 64


def rows() -> Iterator[Row]:
    """Measure the inversions of all kinds of target, and the arrangements."""
    points = mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12])
    rng = np.random.default_rng(0)
    height, load = rng.exponential(0.03, 64), np.linspace(0.02, 0.5, 30)
    sampled = mf.SampledLaw(load, mf.Independent().curves(height, RADIUS, load)[2][0])
    for name, model in MODELS.items():
        yield from _pair(f"operating points, {name}", points, model, 1e-9, 0.015, mf.Limits(0.27))
    for name in ("half-space", "layer"):
        yield from _pair(f"30 samples, {name}", sampled, MODELS[name], 1e-3, 0.2, LIMITS)
    for exponent in (2 / 3, 0.8, 1.0, 1.2, 1.35):
        for name, model in MODELS.items():
            law = mf.PowerLaw(exponent, (0.1, 0.4))
            yield from _pair(f"exponent {exponent:.3g}, {name}", law, model, 1.5e-3, 0.2, LIMITS)
    target = mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26))
    for name, model in MODELS.items():
        fits = mf.design(target, LATTICE, model, LIMITS).fits
        worst = max(abs(fit.slope / branch.slope - 1.0) for branch, fit in fits)
        yield Row(f"slopes 9.5 and 7, {name}: worst slope", 0.01, worst)
    yield Row("largest exponent within 1 %, at most 1.667", 1.667, _largest_exponent())
    yield from _random_laws()
    failed = sum(_misfit(mixed_law(seed, TOOLS), tools=TOOLS) > 2e-3 for seed in range(MIXED_LAWS))
    yield Row(f"{MIXED_LAWS} random laws of three radii, not recovered to 0.2 %", 5, failed)
    yield from _large()
    yield from _arranged(SIDES[0], 3.0)
    yield from _arranged(SIDES[1], 60.0)


def long_rows() -> list[Row]:
    """Measure the arrangement of thousands of asperities."""
    measured = [*_arranged(LARGEST, 240.0)]
    return [*measured, Row(f"memory after arranging {LARGEST**2} asperities", 4.0, peak_memory(), "GiB")]


def _arranged(side: int, seconds: float) -> Iterator[Row]:
    """Arrange random heights so that their law follows that of independent asperities."""
    count = side**2
    width = side * 1.5 + 8.0
    lattice = mf.Surface.square_lattice(
        np.random.default_rng(1).exponential(0.03, count), (side, side), radius=RADIUS,
        material=mf.Material(1.36), block=mf.Block(width, width, 7.2),
    )  # fmt: skip
    objective = mf.FollowLaw(count / 64 * 0.03 * np.arange(1, 21))
    for name in ("half-space", "layer"):
        taken, result = took(partial(mf.arrange, lattice, objective, MODELS[name]))
        what = f"arrangement of {count} asperities, {name}"
        yield Row(f"{what}: time", seconds, taken, "s")
        yield Row(f"{what}: misfit, before {result.before:.2g}", result.before, result.after)


def _pair(name: str, target, model, misfit, seconds, limits) -> list[Row]:
    work = partial(mf.design, target, LATTICE, model, limits)
    return [Row(f"{name}: misfit", misfit, work().misfit), Row(f"{name}: time", seconds, best(work, 2), "s")]


def _largest_exponent() -> float:
    low, high = 1.35, 1.667
    while high - low > 2e-3:
        middle = 0.5 * (low + high)
        result = mf.design(mf.PowerLaw(middle, (0.1, 0.4)), LATTICE, limits=LIMITS)
        low, high = (middle, high) if result.misfit <= 0.01 else (low, middle)
    return low


def _random_laws() -> Iterator[Row]:
    """Invert laws of random surfaces of independent asperities under every model."""
    limits, seconds, failed = mf.Limits(0.6), [], 0
    for model in MODELS.values():
        for seed in range(RANDOM_LAWS):
            taken, result = took(partial(mf.design, random_law(seed), LATTICE, model, limits))
            seconds.append(taken)
            failed += result.misfit > 2e-3
    yield Row(f"{ALL_LAWS} random laws, not recovered to 0.2 % [%]", 0.5, 100.0 * failed / ALL_LAWS)
    yield Row(f"{ALL_LAWS} random laws: 99 % of the times", 0.3, float(np.percentile(seconds, 99)), "s")


def _misfit(law: mf.SampledLaw, **options) -> float:
    return mf.design(law, LATTICE, limits=mf.Limits(0.6), **options).misfit


def _large() -> list[Row]:
    """Design a sampled law of 40 loads on a lattice of 4,096 asperities on the layer."""
    rng = np.random.default_rng(1)
    height, load = rng.exponential(0.03, 4096), np.linspace(1.0, 30.0, 40)
    target = mf.SampledLaw(load, mf.Independent().curves(height, RADIUS, load)[2][0])
    lattice = mf.Surface.square_lattice(
        0.3, (64, 64), radius=RADIUS, material=mf.Material(1.36), block=mf.Block(120.0, 120.0, 7.2)
    )
    taken, result = took(lambda: mf.design(target, lattice, MODELS["layer"], LIMITS))
    return [
        Row("4,096 asperities, layer, 40 loads: time", 60.0, taken, "s"),
        Row("4,096 asperities, layer, 40 loads: misfit", 1e-3, result.misfit),
    ]
