"""Compression tests of caps with known E* and adhesion energy."""

import math

import numpy as np

import metafem as mf
from metafem.calibration import MeasurementErrors

RADIUS, MODULUS, ENERGY = 0.526, 1.36, 9e-6
A = np.linspace(0.08, 0.4, 20)
AREA = math.pi * A**2


def load_of(a, energy=ENERGY, modulus=MODULUS):
    """Return exact loads of one contact at radii."""
    rescaled = mf.Hertz().load(a, RADIUS)
    return modulus * rescaled - np.sqrt(8.0 * math.pi * energy * modulus * a**3)


def noisy(seed, contacts=1, energy=ENERGY, modulus=MODULUS):
    """Return loads and total areas with the errors of the paper."""
    errors, rng = MeasurementErrors(), np.random.default_rng(seed)
    load = contacts * load_of(A, energy=energy, modulus=modulus) + errors.load * rng.standard_normal(A.size)
    total = contacts * AREA
    return load, total + errors.of_area(total) * rng.standard_normal(A.size)
