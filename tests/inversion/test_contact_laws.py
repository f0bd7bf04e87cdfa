"""Designs under contact laws other than Hertz's."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
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
@settings(max_examples=4)
@given(seed=st.integers(0, 10**6))
def test_laws_of_random_surfaces_are_recovered(exponent, seed):
    model, rng = mf.Independent(contact=mf.PowerCap(exponent)), np.random.default_rng(seed)
    height, load = rng.exponential(rng.uniform(0.01, 0.05), 64), np.linspace(0.02, 0.5, 20)
    target = mf.SampledLaw(load, model.curves(height, RADIUS, load)[2][0])
    assert mf.design(target, LATTICE, model, mf.Limits(0.6)).misfit <= 1e-2


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
