"""Designs under contact laws other than Hertz's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.inversion.bounds import Bounds
from metafem.inversion.tools.radii import Radii
from validation.scenes.random_laws import LATTICE, RADIUS

POINTS = mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12])


def table_of_a_sphere():
    rho = np.linspace(0.0, 0.5, 120)
    return mf.AxisymmetricCap([rho, RADIUS - np.sqrt(RADIUS**2 - rho**2)])


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


def test_adhesive_asperities_have_a_power_law():
    target = mf.PowerLaw(0.8, (0.1, 0.4))
    result = mf.design(target, LATTICE, mf.Independent(contact=mf.JKR(9e-6)), mf.Limits(0.3))
    assert result.misfit <= 1e-3
