"""Stress and tangent are the slopes of the energy, in plain numpy."""

import numpy as np
import pytest

from validation.finite_elements.large_strain import neo_hookean

MU = 0.25

RNG = np.random.default_rng(3)

STRAIN = 0.2 * RNG.normal(size=(4, 5))

PRESSURE = 0.1 * RNG.normal(size=4)


def energy(h):
    """The whole functional of one state, with F written out."""
    (a, b), (c, d) = np.eye(2) + h[:4].reshape(2, 2)
    stretch = 1.0 + h[4]
    volume = (a * d - b * c) * stretch
    return 0.5 * MU * (a * a + b * b + c * c + d * d + stretch**2 - 3.0 - 2.0 * np.log(volume)), volume - 1.0


def slope(function, h, step=1e-6):
    return np.array([(function(h + e) - function(h - e)) / (2.0 * step) for e in step * np.eye(5)])


def test_energy_and_volume():
    for h in STRAIN:
        stored, volume = energy(h)
        assert neo_hookean.energy(h, MU) == pytest.approx(stored, rel=1e-12)
        assert neo_hookean.volume_change(h) == pytest.approx(volume, rel=1e-12)


def test_stress_and_tangent_are_the_slopes_of_the_energy_and_of_the_stress():
    for h, p in zip(STRAIN, PRESSURE, strict=True):
        expected = slope(lambda x, p=p: energy(x)[0] - p * energy(x)[1], h)
        np.testing.assert_allclose(neo_hookean.stress(h, p, MU), expected, atol=1e-8)

        expected = slope(lambda x, p=p: neo_hookean.stress(x, p, MU), h)
        np.testing.assert_allclose(neo_hookean.tangent(h, p, MU), expected, atol=1e-8)


def test_tiny_strains_keep_their_digits():
    h = 1e-12 * STRAIN[0]
    small = np.array([2 * h[0], h[1] + h[2], h[1] + h[2], 2 * h[3], 2 * h[4]])
    np.testing.assert_allclose(neo_hookean.stress(h, np.array(0.0), MU), MU * small, rtol=1e-9)
