"""Height maps of four caps."""

import numpy as np

import metafem as mf
from validation.scenes.height_maps import Placement, height_map

PIXEL = 4e-3
FOUR = mf.Surface.square_lattice([0.05, 0.12, 0.2, 0.27], (2, 2), radius=0.526, material=mf.Material(1.36))


def lattice(rng, shape=(8, 8)):
    height = rng.uniform(0.05, 0.27, shape[0] * shape[1])
    return mf.Surface.square_lattice(height, shape, 1.5, radius=0.526, material=mf.Material(1.36))


def mapped(**options):
    """Return the height map of the four caps, (800, 800)."""
    return height_map(FOUR, (800, 800), PIXEL, placement=Placement(0.01, (1.62, 1.55)), **options)


def damaged(values, kind):
    """Damage a map: dust, spikes, dropouts, a steeper base plane, or tool marks with a period of 50 um."""
    rng, x = np.random.default_rng(1), PIXEL * np.arange(values.shape[1])
    if kind == "dust":
        for i, j in rng.integers(0, 790, (130, 2)):
            values[i : i + 7, j : j + 7] += rng.uniform(5e-3, 50e-3)
    elif kind == "spikes":
        values[rng.random(values.shape) < 0.01] += 0.2
        values[rng.random(values.shape) < 0.01] -= 0.2
    elif kind == "dropouts":
        values[rng.random(values.shape) < 0.6] = np.nan
    elif kind == "steep":
        values += (0.02 * x + 0.01 * x[:, None] + 1e-3 * (x - 1.6) ** 2).astype(np.float32)
    else:
        values += (1e-3 * np.sin(2.0 * np.pi / 0.05 * x)).astype(np.float32)
    return values
