"""The closed forms against which tests and validation compare."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import j0

from metafem import reference as exact


def test_power_law_of_two_is_hertz():
    assert exact.power_law(0.2, 0.5, 2.0) == pytest.approx(exact.hertz(0.2, 1.0), rel=1e-14)


def test_sphere_is_a_paraboloid_for_small_contacts():
    assert exact.sneddon_sphere(1e-3, 1.0) == pytest.approx(exact.hertz(1e-3, 1.0), rel=1e-6)


def test_adhesive_contact_carries_its_load():
    """P = 4 a^3/(3 R) - sqrt(8 pi w a^3) with E* = 1, and Hertz's radius without adhesion."""
    a = exact.jkr_contact_radius(0.01, 0.5, 1e-5)
    load = 4.0 / 3.0 * a**3 / 0.5 - math.sqrt(8.0 * math.pi * 1e-5 * a**3)
    assert load == pytest.approx(0.01, rel=1e-12)
    assert exact.hertz(exact.jkr_contact_radius(0.01, 0.5, 0.0), 0.5)[0] == pytest.approx(0.01, rel=1e-14)


def test_hertz_field_meets_the_contact_and_decays_as_a_point_load():
    load, indentation = exact.hertz(0.2, 1.0)
    assert exact.hertz_displacement(np.array(0.2), 0.2, 1.0) == pytest.approx(indentation - 0.02, rel=1e-12)
    # The next term is a^2/(10 r^2) = 1e-5 at r = 100 a.
    assert exact.hertz_displacement(np.array(20.0), 0.2, 1.0) == pytest.approx(
        load / (20 * math.pi), rel=2e-5
    )


def test_hankel_integral_against_adaptive_quadrature():
    for r in (0.0, 1.3):
        value, _ = quad(
            lambda x, r: (exact.layer_multiplier(np.array(x), 0.3) - 1.0) * j0(x * r),
            0.0,
            50.0,
            args=(r,),
            limit=400,
            epsabs=1e-12,
        )
        assert exact.layer_regular(r, 1.0, 0.3) == pytest.approx(value / math.pi, abs=1e-11)


def test_laplacian_is_the_influences():
    r, h = 1.1, 1e-3
    lower, middle, upper = exact.layer_regular([r - h, r, r + h], 1.0, 0.5)
    numeric = (upper - 2 * middle + lower) / h**2 + (upper - lower) / (2 * h * r)
    # Central differences: h^2 of a field of order one.
    assert exact.layer_laplacian(r, 1.0, 0.5) == pytest.approx(numeric, abs=1e-5)


def test_contacts_on_a_thin_layer_do_not_interact():
    # A cell ten thicknesses wide is the layer alone.
    cell = exact.layer_cell(0.05, 10.0, 1.0, 0.5)
    assert cell == pytest.approx(float(exact.layer_regular(0.0, 1.0, 0.5)), rel=1e-3)


def test_conductance_of_one_contact_is_that_of_a_disc():
    """A disc of radius a between half-spaces has G = 4 a/(rho_1 + rho_2); its stiffness is 2 E* a."""
    assert exact.conductance(2.0 * 1.36 * 0.2, 1.36, 3.0) == pytest.approx(4.0 * 0.2 / 3.0, rel=1e-14)
