"""Synthetic measurements of sheared contacts with the errors of the paper."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration import MeasurementErrors

ERRORS = MeasurementErrors()

# B of batch 1 and sigma of Fig. 3 of the paper [MPa].
RATIO, STRENGTH = 0.85, 0.37


def sheared(
    rng: np.random.Generator, shape: tuple[int, ...] = (), tests: int = 3, loads: int = 20, contacts: int = 1
) -> tuple[FloatArray, FloatArray]:
    """Return A0, Af and F (..., 3, k) of contact radii from 0.08 to 0.4 mm with noise, and without."""
    radius = np.tile(np.linspace(0.08, 0.4, loads), tests)
    before = contacts * np.pi * radius**2
    exact = np.stack([before, RATIO * before, STRENGTH * RATIO * before])
    deviation = np.stack(
        [ERRORS.of_area(exact[0]), ERRORS.of_area(exact[1]), ERRORS.of_friction_force(exact[2])]
    )
    return exact + deviation * rng.standard_normal((*shape, *exact.shape)), exact
