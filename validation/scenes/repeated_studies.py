"""Repeated studies of manufacturing errors, and how often their errors hold the mean."""

from __future__ import annotations

import numpy as np

import metafem as mf

# Student's factor for 16 batches lowers the expectation of 68 % to this.
EXPECTED = 0.667

PAIR = mf.Surface.square_lattice(
    [0.1, 0.105, 0.11, 0.13], (2, 2), radius=0.526, material=mf.Material(composite_modulus=1.36)
)
HEIGHT_SD, DRAWS, LOAD_RANGE = 0.003, 512, (0.005, 0.02)
MOMENTS = ("slope_mean", "slope_sd", "area_mean", "area_sd")


def coverage(repetitions: int) -> np.ndarray:
    """Return the share of studies within their error of the mean of all, for each of the moments (4,)."""
    studies = [
        mf.studies.manufacturing(PAIR, HEIGHT_SD, draws=DRAWS, load_range=LOAD_RANGE, rng=seed)
        for seed in range(repetitions)
    ]
    last = [
        [[study[name].values.ravel()[-1], study[f"{name}_error"].values.ravel()[-1]] for name in MOMENTS]
        for study in studies
    ]
    value, error = np.moveaxis(np.array(last), -1, 0)
    return np.asarray((np.abs(value - value.mean(axis=0)) <= error).mean(axis=0))


def tolerance(repetitions: int) -> float:
    """Return three standard deviations of the share of so many studies."""
    return float(3.0 * np.sqrt(EXPECTED * (1.0 - EXPECTED) / repetitions))
