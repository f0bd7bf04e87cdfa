"""Pressed contacts against closed forms, physics.md's rows and each other."""

import functools
import math

import numpy as np
import pytest

import metafem as mf
from metafem import reference as exact

R = 0.526

# Asked of the half-space's high-order elements.
SPECTRAL = 1e-7


@functools.cache
def half_space(poisson_ratio=0.5):
    return mf.fe.press(0.2, R, poisson_ratio)


@functools.cache
def block(height, contact_radius):
    return mf.fe.press(contact_radius, R, height=height, thickness=7.2, block_radius=10.0)


def overestimates(contact, error):
    """The estimate bounds the error, and by no more than a factor of 1000."""
    return error <= contact.error_estimate <= 1000.0 * max(error, np.finfo(float).eps)


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.5])
def test_hertz_load_and_indentation(poisson_ratio):
    contact = half_space(poisson_ratio)
    load, indentation = exact.hertz(0.2, R)
    errors = [abs(contact.rescaled_load / load - 1.0), abs(contact.indentation / indentation - 1.0)]
    assert max(errors) < SPECTRAL
    assert overestimates(contact, max(errors))


def test_hertz_field_outside():
    for poisson_ratio in [0.0, 0.5]:
        r = 0.2 * np.array([1.0001, 1.1, 2.0, 10.0, 1000.0])
        np.testing.assert_allclose(
            half_space(poisson_ratio).displacement(r), exact.hertz_displacement(r, 0.2, R), rtol=SPECTRAL
        )


def test_hertz_pressure_and_shape_inside():
    assert not half_space().pressure([0.2, 0.3]).any()
    r = np.array([0.0, 0.05, 0.1, 0.19])
    np.testing.assert_allclose(half_space().pressure(r), exact.hertz_pressure(r, 0.2, R), rtol=1e-6)
    np.testing.assert_allclose(
        half_space().displacement(r), half_space().indentation - r**2 / (2 * R), rtol=SPECTRAL
    )


def test_other_profiles_show_that_hertz_is_not_built_in():
    for a, profile, expected in [
        (0.3, lambda r: 0.7 * r**4, exact.power_law(0.3, 0.7, 4.0)),
        (0.26, lambda r: R - np.sqrt(R**2 - r**2), exact.sneddon_sphere(0.26, R)),
    ]:
        contact = mf.fe.press(a, profile=profile)
        error = np.abs(np.divide((contact.rescaled_load, contact.indentation), expected) - 1.0).max()
        assert error < SPECTRAL
        assert overestimates(contact, error)


def test_cap_on_the_bonded_block():
    """Load and indentation over Hertz's at the same a, of an independent small-strain computation to .2 %."""
    contact, hertz = block(0.20, 0.26), exact.hertz(0.26, R)
    assert contact.rescaled_load / hertz[0] == pytest.approx(1.112, rel=2e-3)
    assert contact.indentation / hertz[1] == pytest.approx(1.121, rel=2e-3)
    assert contact.error_estimate < 1e-4


def test_pressure_on_the_cap_carries_the_load():
    contact = block(0.20, 0.26)
    x, w = np.polynomial.legendre.leggauss(60)
    angle = 0.25 * math.pi * (x + 1.0)
    r = 0.26 * np.sin(angle)
    total = (0.25 * math.pi * w * 2.0 * math.pi * r * contact.pressure(r) * 0.26 * np.cos(angle)).sum()
    assert total == pytest.approx(contact.rescaled_load, rel=1e-3)


def test_a_residual_that_stays_is_reported(monkeypatch):
    monkeypatch.setattr("metafem.fe.elements.RESIDUAL", 0.0)
    with pytest.raises(mf.NotConverged, match="residual"):
        mf.fe.press(0.2, R)
