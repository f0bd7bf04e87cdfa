"""Random surfaces of few asperities and their loads, crowded ones and merged contacts among them."""

from __future__ import annotations

import numpy as np

import metafem as mf

# Ranges of the mean distance and of the smallest distance of two sites [mm]; the nearest contacts merge.
SPACING, CLOSEST = (0.4, 1.5), (0.1, 0.4)

# Rescaled load P/E* of each asperity [mm²].
LOAD = (5e-4, 2e-2)


def random_surface(seed: int) -> tuple[mf.Surface, float]:
    """Return a surface of 3 to 16 asperities and a load [N]."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(3, 17))
    closest = rng.uniform(*CLOSEST)
    width = rng.uniform(*SPACING) * np.sqrt(count)
    position = rng.uniform(0.0, width, (1, 2))
    while len(position) < count:
        site = rng.uniform(0.0, width, 2)
        if np.hypot(*(position - site).T).min() >= closest:
            position = np.vstack([position, site])
        else:
            width *= 1.01  # a crowded square grows until the next site fits
    height = 0.1 + rng.exponential(0.03, count)
    load = count * float(np.exp(rng.uniform(*np.log(LOAD))))
    material = mf.Material(1.36)
    return mf.Surface(position, height, 0.526, material), load * material.composite_modulus
