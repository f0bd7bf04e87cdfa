"""Designs under contact laws other than Hertz's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.inversion.bounds import Bounds
from metafem.inversion.height_density import ExponentialDensity
from metafem.inversion.strategies.mixture import Mixture
from metafem.inversion.tools.radii import Radii
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


@pytest.mark.parametrize("exponent", [1.5, 4.0])
@settings(max_examples=2)
@given(seed=st.integers(0, 10**6))
def test_laws_of_random_surfaces_are_recovered(exponent, seed):
    model, rng = mf.Independent(contact=mf.PowerCap(exponent)), np.random.default_rng(seed)
    height, load = rng.exponential(rng.uniform(0.01, 0.05), 64), np.linspace(0.02, 0.5, 20)
    target = mf.SampledLaw(load, model.curves(height, RADIUS, load)[2][0])
    assert mf.design(target, LATTICE, model, mf.Limits(0.6)).misfit <= 1e-2


@pytest.mark.slow
@pytest.mark.parametrize(
    "law", [mf.SphericalCap(), mf.KogutEtsion(5.0), mf.JKR(9e-6), table_of_a_sphere()], ids=repr
)
@settings(max_examples=5)
@given(seed=st.integers(0, 10**6))
def test_laws_of_random_surfaces_are_recovered_under_every_law(law, seed):
    """With adhesion a contact enters with a jump of its area, which other entries cannot follow."""
    model, rng = mf.Independent(contact=law), np.random.default_rng(seed)
    height, load = rng.exponential(rng.uniform(0.01, 0.05), 64), np.linspace(0.02, 0.2, 20)
    target = mf.SampledLaw(load, model.areas(LATTICE, load, height[None])[0])
    assert mf.design(target, LATTICE, model, mf.Limits(0.5)).misfit <= 1e-2


@pytest.mark.parametrize("law", [mf.KogutEtsion(5.0), mf.TabulatedContact], ids=["plastic", "table"])
def test_laws_without_a_profile(law):
    """They couple by order 1."""
    if law is mf.TabulatedContact:
        depth = np.linspace(0.0, 0.4, 80)
        law = law(depth, 1.36 * 4.0 / 3.0 * np.sqrt(RADIUS) * depth**1.5, np.pi * RADIUS * depth)
    target, limits = mf.OperatingPoints([0.1, 0.2], [0.8, 1.5]), mf.Limits(0.27)
    for model in (mf.Independent(contact=law), mf.Interacting(order=1, contact=law)):
        assert mf.design(target, LATTICE, model, limits).misfit <= 1e-9


def test_a_small_exponent_needs_flat_caps():
    target, limits = mf.PowerLaw(0.5, (0.1, 0.4)), mf.Limits(0.27)
    assert mf.design(target, LATTICE, mf.Independent(contact=mf.PowerCap(4)), limits).misfit <= 2e-3
    with pytest.raises(mf.Infeasible, match=r"at least 0\.6667"):
        mf.design(target, LATTICE, limits=limits)
    with pytest.raises(mf.Infeasible, match=r"at least 0\.4 "):
        mf.design(mf.PowerLaw(0.38, (0.1, 0.4)), LATTICE, mf.Independent(contact=mf.PowerCap(4)), limits)


def test_the_bounds_are_those_of_the_law():
    target = mf.SampledLaw([0.02, 0.1], [0.15, 0.6])
    assert mf.design(target, LATTICE, limits=mf.Limits(0.3)).misfit <= 1e-2
    with pytest.raises(mf.Infeasible, match=r"sample 1 .* below that of a single asperity, 0\.224451"):
        mf.design(target, LATTICE, mf.Independent(contact=mf.PowerCap(4)), mf.Limits(0.3))


def test_operating_points_of_a_tabulated_profile():
    result = mf.design(
        mf.OperatingPoints([0.02, 0.05], [0.15, 0.35]), LATTICE,
        mf.Independent(contact=table_of_a_sphere()), mf.Limits(0.27),
    )  # fmt: skip
    assert result.misfit <= 1e-9


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


@pytest.mark.parametrize("objective", [mf.FollowLaw, mf.InsensitiveToTilt])
def test_flat_caps_are_arranged(objective):
    model, load = mf.Interacting(contact=mf.PowerCap(4)), np.linspace(0.02, 0.1, 5)
    height = 0.2 - np.random.default_rng(2).exponential(0.02, 16)
    surface = mf.Surface.square_lattice(height, (4, 4), radius=RADIUS, material=mf.Material(1.36))
    found = mf.arrange(surface, objective(load), model)
    assert found.after <= 0.6 * found.before


@pytest.mark.slow
def test_lines_of_other_caps_are_met_over_their_range():
    line, limits, cap = mf.LinearLaw(7.0), mf.Limits(0.27), mf.PowerCap(1.5)
    ends = mf.achievable_load_range(line, LATTICE, limits, contact=cap)
    found = mf.design(mf.LinearLaw(7.0, ends), LATTICE, mf.Independent(contact=cap), limits)
    assert found.misfit <= 0.01
    bounds = Bounds(cap, Radii.of(RADIUS), 64, ends[1])
    assert bounds.start_of_line(7.0) <= ends[0] < ends[1] <= bounds.end_of_line(7.0, 0.0)


@pytest.mark.parametrize("model", [mf.Interacting, mf.MeanField])
def test_flat_caps_meet_points_with_interaction(model):
    result = mf.design(POINTS, LATTICE, model(contact=mf.PowerCap(4)), mf.Limits(0.27))
    assert result.misfit <= 1e-9


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


def test_adhesive_asperities_have_a_power_law():
    target = mf.PowerLaw(0.8, (0.1, 0.4))
    result = mf.design(target, LATTICE, mf.Independent(contact=mf.JKR(9e-6)), mf.Limits(0.3))
    assert result.misfit <= 1e-3
