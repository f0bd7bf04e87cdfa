"""Caps of any profile against quadrature, closed forms and the energy of a contact."""

from functools import cache
from itertools import product

import mpmath
import numpy as np
from numpy.testing import assert_allclose

import metafem as mf
from metafem.contact import Contact

RADIUS = 0.526
POWERS = [mf.Elastic(mf.Power(n, 0.5)) for n in (1.1, 1.5, 3, 4, 8)]
CAPS = [*POWERS, mf.Elastic(mf.Sphere())]


def slope_of(cap, rho):
    """f'(rho) of a cap, in high precision."""
    if cap == mf.Elastic(mf.Sphere()):
        return rho / mpmath.sqrt(mpmath.mpf(RADIUS) ** 2 - rho**2)
    n = mpmath.mpf(cap.cap.exponent)
    return n * mpmath.mpf(cap.cap.coefficient) * (rho / mpmath.mpf(RADIUS)) ** (n - 1)


@cache
def exact(cap, a):
    """Indentation, load and second moment from the profile, by quadrature over rho = a sin(t)."""
    edge = slope_of(cap, mpmath.mpf(a))

    def integral(power):
        """I_k = int_0^a f' rho^k/sqrt(a^2 - rho^2) drho."""

        def part(t):  # of order one, as the quadrature needs it
            return slope_of(cap, a * mpmath.sin(t)) / edge * mpmath.sin(t) ** power

        return edge * mpmath.mpf(a) ** power * mpmath.quad(part, [0, mpmath.pi / 4, mpmath.pi / 2])

    fourth, second = integral(4), integral(2)
    return a * integral(0), 2 * second, 4 * (2 * fourth - mpmath.mpf(a) ** 2 * second) / 3


def test_caps_are_those_of_their_profiles():
    for cap, ratio in product(CAPS, (1e-4, 0.29, 0.31, 0.9)):
        assert_exact(cap, ratio * RADIUS)


def assert_exact(cap, a):
    with mpmath.workdps(30):
        own = [float(value) for value in exact(cap, a)]
    found = [function(a, RADIUS) for function in (cap.indentation, cap.load, cap.second_moment)]
    assert_allclose(found, own, rtol=1e-12)


def test_contact_radius_is_the_inverse_of_the_indentation():
    for cap in (*CAPS[1::2], mf.Elastic(mf.Sphere()), mf.Hertz()):
        a = RADIUS * np.concatenate([np.geomspace(1e-8, 0.3, 40), np.linspace(0.3, 0.99, 40)])
        d = cap.indentation(a, RADIUS)
        assert_allclose(cap.contact_radius(d, RADIUS), a, rtol=1e-12)
        assert cap.contact_radius(-0.1, RADIUS) == 0.0
        assert cap.contact_radius(np.array([]), RADIUS).shape == (0,)
        assert isinstance(cap, Contact)
        assert cap.area_slope(0.0, RADIUS) == 0.0


def test_a_power_of_two_is_the_paraboloid():
    d = np.array([-0.01, 0.0, 1e-9, 0.01, 0.1])
    power, hertz = mf.Elastic(mf.Paraboloid()), mf.Hertz()
    a = hertz.contact_radius(d, RADIUS)
    assert_allclose(power.contact_radius(d, RADIUS), a, rtol=1e-14)
    for name in ("indentation", "load", "second_moment", "stiffness", "area_slope"):
        found, expected = (getattr(law, name)(a, RADIUS) for law in (power, hertz))
        assert_allclose(found, expected, rtol=1e-14)
    assert_allclose(power.area(a), hertz.area(a), rtol=1e-15)


def test_the_profile_scales_with_the_radius():
    for cap in (*CAPS, mf.Hertz()):
        assert cap.depth_at(0.0, RADIUS) == 0.0
        depth = cap.depth_at(np.array([0.1, 0.2]), np.array([0.5, 1.0]))
        assert_allclose(depth * [2.0, 1.0], cap.depth_at(0.2, 1.0))


def test_a_sphere_is_continued_by_its_tangent():
    rho = RADIUS * np.array([0.5, 0.99, 0.9994001, 1.0, 2.0])
    depth = mf.Elastic(mf.Sphere()).depth_at(rho, RADIUS)
    assert_allclose(depth[:2], RADIUS - np.sqrt(RADIUS**2 - rho[:2] ** 2), rtol=1e-14)
    slope = 0.9994 / np.sqrt(1.0 - 0.9994**2)
    assert_allclose(np.diff(depth)[2:], slope * np.diff(rho)[2:], rtol=1e-5)  # a difference quotient


def test_the_indentation_of_a_paraboloid_at_a_load():
    d = np.array([1e-6, 0.01, 0.1])
    load = 4.0 / 3.0 * np.sqrt(RADIUS) * d**1.5
    assert_allclose(mf.Hertz().indentation_at_load(load, RADIUS), d, rtol=1e-14)
