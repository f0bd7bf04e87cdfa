"""Synthetic compression tests of equal caps, with the measurement errors of Aymard et al. (2024)."""

from __future__ import annotations

import math

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import MeasurementErrors
from metafem.calibration.compression.distance_fit import DistanceFit, distance_fit
from metafem.calibration.compression.scene import cap_curve

RADIUS, MODULUS, ENERGY = 0.526, 1.36, 9e-6  # mm, MPa, N/mm: batch 1
ERRORS = MeasurementErrors()

# Contact radii of the 20 loads of a test [mm], and the number of tests.
RADII, TESTS = np.linspace(0.08, 0.4, 20), 3


def loads(contact_radius: FloatArray, energy: float = ENERGY) -> FloatArray:
    """Return the load [N] of one cap by Johnson, Kendall and Roberts."""
    law = mf.JKR(energy).for_material(mf.Material(MODULUS))
    return np.asarray(MODULUS * law.load(contact_radius, RADIUS))


def compression_tests(
    trials: int, contacts: int, energy: float, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Return measured loads and total areas of equal contacts, (trials, 60): three tests of 20 loads."""
    a = np.tile(RADII, TESTS)
    area = contacts * math.pi * a**2
    load = contacts * loads(a, energy) + ERRORS.load * rng.standard_normal((trials, a.size))
    return load, area + ERRORS.of_area(area) * rng.standard_normal((trials, a.size))


def fitted(load: FloatArray, area: FloatArray, contacts: int) -> DistanceFit:
    """Return the fits to many sets of loads and total areas, (trials, k)."""
    return distance_fit(
        load,
        area[..., None] / contacts,
        cap_curve(mf.Hertz(), RADIUS).load_and_slope,
        contacts=contacts,
        load_sd=ERRORS.load,
        area_sd=lambda of: ERRORS.of_area(of) / math.sqrt(contacts),
    )
