"""Compression tests of caps with known E* and adhesion energy."""

import math

import numpy as np

import metafem as mf
from metafem.calibration import MeasurementErrors, Sample

RADIUS, MODULUS, ENERGY = 0.526, 1.36, 9e-6
A = np.linspace(0.08, 0.4, 20)
AREA = math.pi * A**2
SMALL = np.linspace(0.05, 0.25, 20)
TABLE = mf.TabulatedContact(
    *np.loadtxt("meshes/soft_cap.csv", delimiter=",", skiprows=1).T, material=mf.Material(1.0)
)


def load_of(a, cap=None, energy=ENERGY, modulus=MODULUS):
    """Return exact loads of one contact at radii."""
    rescaled = (cap or mf.Hertz()).load(a, RADIUS)
    return modulus * rescaled - np.sqrt(8.0 * math.pi * energy * modulus * a**3)


def of_cap(cap, contacts=1):
    """Return a sample of contacts of a law."""
    return Sample(contacts, contact=cap)


def noisy(seed, contacts=1, energy=ENERGY, modulus=MODULUS):
    """Return loads and total areas with the errors of the paper."""
    errors, rng = MeasurementErrors(), np.random.default_rng(seed)
    load = contacts * load_of(A, energy=energy, modulus=modulus) + errors.load * rng.standard_normal(A.size)
    total = contacts * AREA
    return load, total + errors.of_area(total) * rng.standard_normal(A.size)
