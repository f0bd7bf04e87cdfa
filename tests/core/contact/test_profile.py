"""Caps given by a function or a table, against the closed forms of powers and spheres."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf
from metafem.caps.shapes import sphere_profile
from tests.models.scenes import scene

RADIUS, EXTENT = 0.526, 0.36
CONTACT_RADII = np.concatenate([np.geomspace(1e-12, EXTENT, 60), np.linspace(0.01, EXTENT, 50)])
QUANTITIES = ("indentation", "load", "second_moment")


def power(exponent):
    return lambda rho: 0.5 * RADIUS * (rho / RADIUS) ** exponent


def sphere(rho):
    return sphere_profile(rho, RADIUS)


CASES = [(mf.Elastic(mf.Profile(power(n), EXTENT)), mf.Elastic(mf.Power(n))) for n in (1.1, 1.5, 4)]


CASES.append((mf.Elastic(mf.Profile(sphere, EXTENT)), mf.Elastic(mf.Sphere())))
PARABOLOID = np.linspace(0.0, EXTENT, 5) ** np.array([[1.0], [2.0]]) / np.array([[1.0], [2.0 * RADIUS]])
CASES.append((mf.Elastic(mf.Profile(PARABOLOID)), mf.Hertz()))


def test_functions_give_the_closed_forms():
    for cap, closed in CASES:
        a = CONTACT_RADII
        for name in QUANTITIES:
            found, expected = (getattr(law, name)(a, RADIUS) for law in (cap, closed))
            assert_allclose(found, expected, rtol=1e-9)
        # the derivative of D is that of an interpolant
        slopes = (law.area_slope(a, RADIUS) for law in (cap, closed))
        assert_allclose(*slopes, rtol=1e-8)
        d = closed.indentation(a, RADIUS)
        assert_allclose(cap.contact_radius(d, RADIUS), a, rtol=1e-9)
        assert cap.contact_radius(-0.1, RADIUS) == cap.load(0.0, RADIUS) == cap.area_slope(0.0, RADIUS) == 0.0


def test_tables_approach_their_profile():
    for points, error in ((10, 3e-3), (100, 1e-5)):
        assert_near_sphere(np.linspace(0.0, EXTENT, points), error)


def assert_near_sphere(rho, error):
    cap = mf.Elastic(mf.Profile([rho, sphere(rho)]))
    for name in QUANTITIES:
        found, expected = (
            getattr(law, name)(CONTACT_RADII, RADIUS) for law in (cap, mf.Elastic(mf.Sphere()))
        )
        assert_allclose(found, expected, rtol=error)
    assert (np.diff(cap.indentation(np.sort(CONTACT_RADII), RADIUS)) > -1e-15).all()


def test_profiles_are_continued_by_their_tangent():
    for table in (False, True):
        rho = np.linspace(0.0, 0.3, 40)
        cap = mf.Elastic(mf.Profile([rho, sphere(rho)] if table else sphere, None if table else 0.3))
        inside = np.array([0.0, 0.01, 0.1234, 0.3])
        assert_allclose(cap.depth_at(inside, RADIUS), sphere(inside), rtol=2e-5 if table else 1e-14)
        beyond = cap.depth_at(np.array([[0.3, 0.4, 0.5]]), RADIUS)
        slope = 0.3 / np.sqrt(RADIUS**2 - 0.3**2)
        assert_allclose(np.diff(beyond), [[0.1 * slope, 0.1 * slope]], rtol=2e-3 if table else 1e-5)
        assert cap.depth_at(0.1, RADIUS).shape == ()


def test_a_profile_is_a_value():
    table = [[0.0, 0.1, 0.2], [0.0, 0.01, 0.04]]
    cap = mf.Elastic(mf.Profile(table))
    assert cap == mf.Elastic(mf.Profile(np.array(table))) != mf.Elastic(mf.Profile(sphere, 0.3))
    assert hash(cap) == hash(mf.Elastic(mf.Profile(table)))
    assert repr(cap) == "Elastic(Profile(<3 points>, extent=0.2))"
    assert repr(mf.Elastic(mf.Profile(sphere, 0.3))) == "Elastic(Profile(sphere, extent=0.3))"
    assert cap.cap.extent == 0.2


def test_loads_and_approaches_reach_up_to_the_extent():
    cap = mf.Elastic(mf.Profile(sphere, 0.1))
    most = float(cap.largest_indentation(RADIUS))
    assert cap.contact_radius(most, RADIUS) == pytest.approx(0.1, rel=1e-12)
    surface, model = scene(radius=np.full(6, RADIUS)), mf.Independent(contact=cap)
    largest = mf.equilibrium(surface, model, approach=most).load
    assert mf.equilibrium(surface, model, load=0.9999 * largest).approach < most
    with pytest.raises(mf.InvalidInput, match="larger range"):
        mf.equilibrium(surface, model, load=1.0001 * largest)
