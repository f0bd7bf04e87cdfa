"""Intervals of repeated studies."""

import numpy as np
import pytest

import metafem as mf

# Share of the studies within one standard error, and their number.
EXPECTED, REPETITIONS = 0.683, 100

PAIR = mf.Surface.square_lattice(
    [0.1, 0.105, 0.11, 0.13], (2, 2), radius=0.526, material=mf.Material(composite_modulus=1.36)
)
MOMENTS = ("slope_mean", "slope_sd", "area_mean", "area_sd")


def test_errors_cover_the_mean_of_many_studies():
    last = []
    for seed in range(REPETITIONS):
        study = mf.studies.manufacturing(PAIR, 0.003, draws=512, load_range=(0.005, 0.02), rng=seed)
        last.append(
            [[study[f"{name}{end}"].values.ravel()[-1] for end in ("", "_error")] for name in MOMENTS]
        )
    value, error = np.moveaxis(np.array(last), -1, 0)
    share = (np.abs(value - value.mean(axis=0)) <= error).mean(axis=0)
    assert share == pytest.approx(EXPECTED, abs=3.0 * np.sqrt(EXPECTED * (1.0 - EXPECTED) / REPETITIONS))
