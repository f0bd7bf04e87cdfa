"""Synthetic measurements of sheared contacts with the errors of the paper."""

import numpy as np

from metafem.calibration import MeasurementErrors

ERRORS = MeasurementErrors()

RATIO, STRENGTH = 0.85, 0.37


def sheared(rng, shape=(), tests=3, loads=20, ratio=RATIO, strength=STRENGTH):
    """Return A0, Af and F (..., 3, k) of contact radii from 0.08 to 0.4 mm with noise, and without."""
    radius = np.tile(np.linspace(0.08, 0.4, loads), tests)
    before = np.pi * radius**2
    exact = np.stack([before, ratio * before, strength * ratio * before])
    deviation = np.stack(
        [ERRORS.of_area(exact[0]), ERRORS.of_area(exact[1]), ERRORS.of_friction_force(exact[2])]
    )
    return exact + deviation * rng.standard_normal((*shape, *exact.shape)), exact
