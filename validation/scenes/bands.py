"""Known surfaces, the same with random errors of height, and bands around the laws of the former."""

import numpy as np

import metafem as mf
from validation.scenes.random_laws import LATTICE, RADIUS

# Half-width of the bands [-], and standard deviation of the errors of the heights [mm].
WIDTH, ERROR = 0.005, 0.005


def scene(seed: int) -> tuple[mf.Surface, mf.Surface, mf.Band]:
    """Return a known surface, the surface with random errors, and a band around the law of the former."""
    rng = np.random.default_rng(seed)
    height = np.maximum(0.2 - rng.exponential(0.03, 64), 0.02)
    known = LATTICE.replaced(height=height)
    full = 4.0 / 3.0 * np.sqrt(RADIUS) * float(((height - height.min()) ** 1.5).sum())
    load = 0.6 * full * np.arange(1, 11) / 10
    law = mf.Independent().curve(known, load).area
    made = known.replaced(height=np.maximum(height + rng.normal(0.0, ERROR, 64), 0.01))
    return known, made, mf.Band(load, (1.0 - WIDTH) * law, (1.0 + WIDTH) * law)
