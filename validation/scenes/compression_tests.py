"""Synthetic compression tests of equal caps, with the measurement errors of Aymard et al. (2024)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from metafem.calibration import MeasurementErrors
from metafem.calibration.compression import fit_areas
from metafem.calibration.statistics import Fit

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


def fitted(load: FloatArray, area: FloatArray, contacts: int) -> Fit:
    """Return the fits to many sets of loads and total areas, (trials, k)."""
    return fit_areas(load, area[..., None] / contacts, RADIUS, contacts, ERRORS)


class Line(NamedTuple):
    """Straight line of Aymard et al. through loads and areas of single contacts: y = intercept + slope x.

    x = pi^(1/4) p/(sqrt(6) a0^(3/4)) and y = a0^(3/4)/(sqrt(6) pi^(5/4) R). For a paraboloid, the law of
    Johnson, Kendall and Roberts is this line with the slope 3/(4 E*) and the intercept sqrt(3 w/(4 E*)).
    Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, "Calibration of individual
    microcontacts". Least squares neglect the errors of x.
    """

    x: FloatArray
    y: FloatArray
    slope: FloatArray
    intercept: FloatArray

    @property
    def composite_modulus(self) -> FloatArray:
        """E* [MPa]."""
        return 0.75 / self.slope

    @property
    def adhesion_root(self) -> FloatArray:
        """Root of the adhesion energy, sqrt(w) [sqrt(N/mm)], with the sign of the intercept."""
        return self.intercept / np.sqrt(self.slope)

    @property
    def adhesion_energy(self) -> FloatArray:
        """Adhesion energy w [N/mm]; 0 if the intercept is negative."""
        return np.maximum(self.adhesion_root, 0.0) ** 2


def straight_line(load: FloatArray, area: FloatArray, radius: float = RADIUS) -> Line:
    """Return the line through loads p [N] and areas a0 [mm^2], (..., k), of single contacts."""
    power = area**0.75
    x = math.pi**0.25 * load / (math.sqrt(6.0) * power)
    y = power / (math.sqrt(6.0) * math.pi**1.25 * radius)
    apart = x - x.mean(axis=-1, keepdims=True)
    slope = (apart * y).sum(axis=-1) / (apart**2).sum(axis=-1)
    return Line(x, y, slope, y.mean(axis=-1) - slope * x.mean(axis=-1))
