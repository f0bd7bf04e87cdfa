"""Designs under contact laws other than Hertz's."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion.height_density import ExponentialDensity
from metafem.inversion.strategies.mixture import Mixture
from validation.scenes.random_laws import LATTICE, RADIUS

POINTS = mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12])


def table_of_a_sphere():
    rho = np.linspace(0.0, 0.5, 120)
    return mf.AxisymmetricCap([rho, RADIUS - np.sqrt(RADIUS**2 - rho**2)])


@pytest.mark.parametrize("cap", [mf.PowerCap(4), mf.PowerCap(3), mf.SphericalCap()], ids=repr)
def test_operating_points_are_met_exactly(cap):
    model = mf.Independent(contact=cap)
    result = mf.design(POINTS, LATTICE, model, mf.Limits(0.27))
    assert result.misfit <= 1e-9
    area = model.curve(result.surface, POINTS.rescaled_load).area
    np.testing.assert_allclose(area, POINTS.rescaled_friction, rtol=1e-9)


@pytest.mark.parametrize("law", [mf.KogutEtsion(5.0), mf.TabulatedContact], ids=["plastic", "table"])
def test_laws_without_a_profile(law):
    """They couple by order 1."""
    if law is mf.TabulatedContact:
        depth = np.linspace(0.0, 0.4, 80)
        law = law(depth, 1.36 * 4.0 / 3.0 * np.sqrt(RADIUS) * depth**1.5, np.pi * RADIUS * depth)
    target, limits = mf.OperatingPoints([0.1, 0.2], [0.8, 1.5]), mf.Limits(0.27)
    for model in (mf.Independent(contact=law), mf.Interacting(order=1, contact=law)):
        assert mf.design(target, LATTICE, model, limits).misfit <= 1e-9


@pytest.mark.parametrize("cap", [mf.PowerCap(3), mf.SphericalCap(), table_of_a_sphere()], ids=repr)
def test_heights_of_a_density_have_its_slope(cap):
    result = mf.design(mf.LinearLaw(6.87), LATTICE, mf.Independent(contact=cap), mf.Limits(0.12))
    assert result.misfit <= 0.1
    slope = result.density.asymptotic_slope(RADIUS, cap)
    assert slope == pytest.approx(6.87, rel=1e-9)
    load = result.target_law.load[-1]
    assert result.density.area(0.0, 64, RADIUS, cap) == pytest.approx(result.target_law.base[-1])
    assert load == pytest.approx(result.parameters["foot_load"])


def test_coefficients_that_densities_of_flat_caps_reach():
    template = LATTICE.replaced(friction=mf.Friction(0.358, 0.85))
    limits, cap = mf.Limits(0.12, height_sd=0.0009), mf.PowerCap(4)
    low, high = mf.achievable_friction_coefficients(template, limits, contact=cap)
    for mu, reached in ((1.001 * low, True), (0.999 * low, False), (0.999 * high, True)):
        target = mf.LinearLaw.from_friction_coefficient(mu, template.material, template.friction)
        if not reached:
            with pytest.raises(mf.Infeasible, match=r"A\(h_m\)/P\(h_m\)"):
                mf.design(target, template, mf.Independent(contact=cap), limits)
        else:
            found = mf.design(target, template, mf.Independent(contact=cap), limits)
            assert not any("the scale" in str(note) for note in found.notes)


def test_tools_are_mixed_by_the_power_of_the_caps():
    mixture = Mixture((0.2, 0.8), (3000, 1000), mf.PowerCap(4))
    density = ExponentialDensity(0.03, 0.12)
    height = np.sort(-0.03 * np.log1p(-np.linspace(0.0, -np.expm1(-4.0), 4001)[1:]))[::-1]
    load, law = np.linspace(1.0, 10.0, 5), mixture.law
    area = mf.Independent(contact=law).curves(height, mixture.mixed(), load)[2][0]
    delta = np.linspace(0.12, 0.0, 2000)
    expected = np.interp(
        load, density.rescaled_load(delta, *mixture.asperities), density.area(delta, *mixture.asperities)
    )
    np.testing.assert_allclose(area, expected, rtol=2e-3)  # the ends of 4,000 intervals, not their middles


def test_adhesive_asperities_meet_points():
    """Bounds of the law without adhesion are not used: contacts have an area at zero load."""
    model = mf.Independent(contact=mf.JKR(9e-6))
    result = mf.design(POINTS, LATTICE, model, mf.Limits(0.27))
    assert result.misfit <= 1e-9
    area = model.areas(result.surface, POINTS.rescaled_load, result.surface.height[None])[0]
    np.testing.assert_allclose(area, POINTS.rescaled_friction, rtol=1e-9)
    low, high = mf.feasible_region(LATTICE, [0.1], mf.Limits(0.27), contact=mf.JKR(9e-6))
    assert low == 0.0
    assert np.isinf(high)
