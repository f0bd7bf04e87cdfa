"""Sampled laws of random surfaces, which an inversion must therefore recover."""

from __future__ import annotations

import math

import numpy as np

import metafem as mf
from metafem._validate import FloatArray

RADIUS = 0.526
LATTICE = mf.Surface.square_lattice(
    0.3, radius=RADIUS, material=mf.Material(1.36), block=mf.Block(20.0, 20.0, 7.2)
)
LIMITS = mf.Limits(0.3, offset=0.05)


def random_law(seed: int, points: int = 30) -> mf.SampledLaw:
    """Return the law of a surface of random heights, so that the law can be reached."""
    rng = np.random.default_rng(seed)
    kind = rng.integers(3)
    if kind == 0:
        height = rng.exponential(rng.uniform(0.005, 0.05), 64)
    elif kind == 1:
        height = rng.uniform(0.0, rng.uniform(0.02, 0.15), 64)
    else:
        height = np.concatenate([rng.normal(0.1, 0.01, 32), rng.normal(0.05, 0.02, 32)])
    full = 4 / 3 * math.sqrt(RADIUS) * float(((height - height.min()) ** 1.5).sum())
    load = full * rng.uniform(0.5, 1.2) * np.arange(1, points + 1) / points
    return mf.SampledLaw(load, mf.Independent().curve_of(height, np.full(64, RADIUS), load).area)


def noisy_law(seed: int) -> tuple[mf.SampledLaw, FloatArray]:
    """Return the law of a random surface as measured at 15 to 30 loads, and its friction without noise.

    The noise of .3 to 3 % is stated as the error of the samples.
    """
    rng = np.random.default_rng(10_000 + seed)
    count, noise = int(rng.integers(15, 31)), float(np.exp(rng.uniform(math.log(0.003), math.log(0.03))))
    true = random_law(seed, count)
    measured = true.rescaled_friction * (1.0 + noise * rng.standard_normal(count))
    error = np.full(count, noise)
    return mf.SampledLaw(true.rescaled_load, measured, relative_error=error), true.rescaled_friction
