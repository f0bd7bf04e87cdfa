"""Pressed contacts against closed forms, physics.md's rows and each other."""

import functools
import math

import numpy as np
import pytest

import metafem as mf
from metafem.contact import pedestal_compliance
from metafem.fe.axisymmetric import press
from metafem.reference import single_contacts as exact

R = 0.526

# Asked of the half-space's high-order elements.
SPECTRAL = 1e-8


@functools.cache
def half_space(poisson_ratio=0.5):
    return mf.fe.press(0.2, R, poisson_ratio)


@functools.cache
def block(height, contact_radius):
    return mf.fe.press(contact_radius, R, height=height, thickness=7.2, block_radius=10.0)


def overestimates(contact, error):
    """The estimate bounds the error, and by no more than a factor of 1000."""
    return error <= contact.error_estimate <= 1000.0 * max(error, np.finfo(float).eps)


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.3, 0.49, 0.5])
def test_hertz_load_and_indentation(poisson_ratio):
    contact = half_space(poisson_ratio)
    load, indentation = exact.hertz(0.2, R)
    errors = [abs(contact.rescaled_load / load - 1.0), abs(contact.indentation / indentation - 1.0)]
    assert max(errors) < SPECTRAL
    assert overestimates(contact, max(errors))


@pytest.mark.parametrize("poisson_ratio", [0.3, 0.5])
def test_hertz_field_outside(poisson_ratio):
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


@pytest.mark.parametrize(
    ("a", "profile", "expected"),
    [
        (0.3, lambda r: 0.7 * r**4, exact.power_law(0.3, 0.7, 4.0)),
        (0.26, lambda r: R - np.sqrt(R**2 - r**2), exact.sneddon_sphere(0.26, R)),
    ],
)
def test_other_profiles_show_that_hertz_is_not_built_in(a, profile, expected):
    contact = mf.fe.press(a, profile=profile)
    error = np.abs(np.divide((contact.rescaled_load, contact.indentation), expected) - 1.0).max()
    assert error < SPECTRAL
    assert overestimates(contact, error)


# Load and indentation over Hertz's at the same a, of an independent small-strain computation to .2 %.
@pytest.mark.parametrize(
    ("height", "contact_radius", "load", "indentation"),
    [pytest.param(0.12, 0.10, 1.016, 1.015, marks=pytest.mark.slow), (0.20, 0.26, 1.112, 1.121)],
)
def test_cap_on_the_bonded_block(height, contact_radius, load, indentation):
    contact = block(height, contact_radius)
    hertz = exact.hertz(contact_radius, R)
    assert contact.rescaled_load / hertz[0] == pytest.approx(load, rel=2e-3)
    assert contact.indentation / hertz[1] == pytest.approx(indentation, rel=2e-3)
    assert contact.error_estimate < 1e-4


def test_pressure_on_the_cap_carries_the_load():
    contact = block(0.20, 0.26)
    x, w = np.polynomial.legendre.leggauss(60)
    angle = 0.25 * math.pi * (x + 1.0)
    r = 0.26 * np.sin(angle)
    total = (0.25 * math.pi * w * 2.0 * math.pi * r * contact.pressure(r) * 0.26 * np.cos(angle)).sum()
    assert total == pytest.approx(contact.rescaled_load, rel=1e-3)


@pytest.mark.slow
def test_graded_mesh_gives_hertz_on_a_deep_block():
    contact = mf.fe.press(1e-5, 1.0, thickness=1.0)
    load, indentation = exact.hertz(1e-5, 1.0)
    error = max(abs(contact.rescaled_load / load - 1.0), abs(contact.indentation / indentation - 1.0))
    assert error < 1e-4
    assert overestimates(contact, error)


def test_lengths_scale():
    big = mf.fe.press(1e3 * 0.26, 1e3 * R, height=1e3 * 0.2, thickness=7.2e3, block_radius=1e4)
    small = block(0.20, 0.26)
    assert big.rescaled_load == pytest.approx(1e6 * small.rescaled_load, rel=1e-9)
    assert big.indentation == pytest.approx(1e3 * small.indentation, rel=1e-9)


@pytest.mark.parametrize(
    "angle", [*(pytest.param(angle, marks=pytest.mark.slow) for angle in (5.0, 45.0, 89.0)), 90.0]
)
def test_any_cap_meshes(angle):
    height = R * (1.0 - math.cos(math.radians(angle)))
    foot = R * math.sin(math.radians(angle))
    contact = mf.fe.press(0.3 * foot, R, height=height, thickness=2.0, block_radius=3.0)
    assert contact.error_estimate < 1e-3


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        ({"contact_radius": 0.0, "radius": R}, "contact_radius"),
        ({"contact_radius": 0.1}, "radius is missing"),
        ({"contact_radius": 0.1, "radius": R, "poisson_ratio": 0.51}, "poisson_ratio"),
        ({"contact_radius": 0.1, "radius": R, "poisson_ratio": -0.1}, "poisson_ratio"),
        ({"contact_radius": 0.1, "radius": R, "profile": np.square}, "profile replaces"),
        ({"contact_radius": 0.1, "radius": R, "height": 0.1}, "needs a thickness"),
        ({"contact_radius": 0.4, "radius": R, "height": 0.12, "thickness": 7.2}, "cap's edge"),
        ({"contact_radius": 0.1, "radius": R, "height": 0.6, "thickness": 7.2}, "height"),
        ({"contact_radius": 0.1, "radius": R, "height": 0.12, "thickness": 0.1}, "thickness"),
        ({"contact_radius": 0.9, "radius": R, "thickness": 7.2, "cell_radius": 0.846}, "cell_radius"),
        ({"contact_radius": 0.1, "radius": R, "height": 0.2, "thickness": 7.2, "block_radius": 0.2}, "foot"),
        ({"contact_radius": 0.1, "profile": lambda r: -(r**2)}, "no load"),
        ({"contact_radius": 0.1, "profile": lambda r: np.nan * r}, "profile"),
    ],
)
def test_bad_input_is_refused_with_its_reason(arguments, reason):
    with pytest.raises(mf.InvalidInput, match=reason):
        mf.fe.press(**arguments)


def test_a_residual_that_stays_is_reported_with_the_state(monkeypatch):
    monkeypatch.setattr("metafem.fe.linear_solve.RESIDUAL", 0.0)
    with pytest.raises(mf.NotConverged, match="residual") as caught:
        mf.fe.press(0.2, R)
    assert caught.value.state.status is mf.fe.LinearStatus.NOT_CONVERGED


def test_a_radius_outside_the_body_is_refused():
    with pytest.raises(mf.InvalidInput, match="radius of the body"):
        block(0.12, 0.10).displacement(11.0)


@pytest.mark.slow
@pytest.mark.parametrize(("height", "contact_radius"), [(0.12, 0.10), (0.20, 0.26)])
def test_estimate_bounds_the_distance_to_a_finer_solution(height, contact_radius):
    from metafem.fe.axisymmetric.geometry import Cap
    from metafem.fe.axisymmetric.mesh import graded_mesh
    from metafem.fe.axisymmetric.prescribed_radius import graded

    cap = Cap(R, height, 10.0, 7.2)
    edge = float(cap.surface(np.array(contact_radius))[0])
    mesh = graded_mesh(edge, 10.0, 7.2, cap.foot, contact_edge=1e-7)
    fine = graded(mesh, cap, 8, 0.5, lambda r: R - np.sqrt(R**2 - r**2), contact_radius, 10.0, False)
    contact = block(height, contact_radius)
    errors = contact.rescaled_load / fine.rescaled_load - 1.0, contact.indentation / fine.indentation - 1.0
    assert overestimates(contact, max(map(abs, errors)))


def test_shortfall_of_the_block_without_a_cap():
    contact = mf.fe.press(10.0, 1.0, thickness=press.PEDESTAL_EXTENT, block_radius=press.PEDESTAL_EXTENT)
    hertz = (0.75 * contact.rescaled_load) ** (2.0 / 3.0)
    short = math.pi * (hertz - contact.indentation) / contact.rescaled_load
    assert short * press.PEDESTAL_EXTENT == pytest.approx(press.SHORTFALL, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("height_ratio", [0.06, 0.23, 0.57])
def test_the_fit_holds_between_the_rows(height_ratio):
    a = 0.3 * math.sqrt(height_ratio * (2.0 - height_ratio))
    # The promise of the table.
    assert pedestal_compliance(height_ratio, 1.0, a) == pytest.approx(
        mf.fe.measure_pedestal(height_ratio, a), rel=1e-3
    )


def test_a_contact_beyond_the_cap_is_refused():
    with pytest.raises(mf.InvalidInput, match="cap's edge"):
        mf.fe.measure_pedestal(0.1, 0.5)
