"""Laws of any shape under any model and contact law."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf
from metafem.inversion import DesignStatus
from validation.scenes.random_laws import LATTICE, LIMITS, RADIUS, random_law

MODELS = [mf.Independent(), mf.Interacting(), mf.Interacting(substrate=mf.BondedLayer())]
POINTS, TALL = mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12]), mf.Limits(0.27)
LOAD = np.array([0.05, 0.1, 0.2])
DEPTH = np.linspace(0.0, 0.4, 80)
HERTZ = mf.TabulatedContact(DEPTH, 1.36 * 4 / 3 * np.sqrt(RADIUS) * DEPTH**1.5, np.pi * RADIUS * DEPTH)


@settings(max_examples=15)
@given(st.integers(0, 10**6))
def test_laws_of_random_surfaces_are_recovered(seed):
    result = mf.design(random_law(seed), LATTICE, limits=mf.Limits(0.6))
    assert result.misfit <= 2e-3
    assert result.status in (DesignStatus.REACHED, DesignStatus.EXACT)


@pytest.mark.parametrize(
    "model",
    [
        *MODELS,
        *(
            mf.Independent(contact=cap)
            for cap in (mf.Elastic(mf.Power(4)), mf.Elastic(mf.Sphere()), mf.JKR(9e-6))
        ),
        mf.Independent(contact=HERTZ),
        mf.Interacting(order=1, contact=mf.KogutEtsion(5.0)),
    ],
    ids=repr,
)
def test_operating_points_are_met_exactly(model):
    result = mf.design(POINTS, LATTICE, model, TALL)
    assert result.status is DesignStatus.EXACT
    areas = [mf.equilibrium(result.surface, model, load=1.36 * p).area for p in POINTS.rescaled_load]
    np.testing.assert_allclose(areas, POINTS.rescaled_friction, rtol=2e-9)


def test_a_model_without_gradients_names_whose_it_uses():
    found = mf.design(POINTS, LATTICE, mf.Automatic(), TALL)
    area = mf.Automatic().curve(found.surface, POINTS.rescaled_load).area
    np.testing.assert_allclose(area, POINTS.rescaled_friction, rtol=1e-9)
    assert any("gradients were those of half-space" in note.text for note in found.notes)


def test_power_laws_are_met_under_every_model():
    for model in MODELS:
        for exponent in (2 / 3, 1.35):
            result = mf.design(mf.PowerLaw(exponent, (0.1, 0.4)), LATTICE, model, LIMITS)
            assert result.misfit <= 1.5e-3
            load = np.array([0.1, 0.2, 0.4])
            area = mf.friction_law(result.surface, model, load=1.36 * load).area
            wanted = result.parameters["prefactor"] * load**exponent
            np.testing.assert_allclose(area, wanted, rtol=1e-2)  # single loads against the rms of 30


def test_indentations_far_below_the_radius_are_found():
    """At R = 1e7 mm the contacts of the target are indented by less than 1e-12 R."""
    template = mf.Surface.square_lattice(0.1, (8, 8), 1.5e7, radius=1e7, material=mf.Material(1.36))
    assert mf.design(mf.PowerLaw(0.9, (1e-4, 1e-3)), template).misfit <= 1.5e-3


def test_a_smaller_second_slope():
    for model in MODELS:
        target = mf.MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26))
        for branch, fit in mf.design(target, LATTICE, model, LIMITS).fits:
            assert fit.slope == pytest.approx(branch.slope, rel=0.01)


def test_branches_that_meet_share_one_intercept():
    result = mf.design(mf.MultilinearLaw([7.0, 9.0], [0.15], (0.05, 0.3)), LATTICE, limits=LIMITS)
    assert len(result.parameters["intercepts"]) == 1
    assert result.misfit <= 0.01


def test_feasible_region_ends_where_the_base_plane_begins():
    low, high = mf.feasible_region(LATTICE, [0.1, 20.0], LIMITS)
    assert high[0] / low[0] == pytest.approx(4.0, rel=1e-12)
    assert np.isnan([low[1], high[1]]).all()
    # with adhesion, contacts have an area at zero load, and nothing is proven
    low, high = mf.feasible_region(LATTICE, [0.1], LIMITS, contact=mf.JKR(9e-6))
    assert (low[0], high[0]) == (0.0, np.inf)


def hertz(count):
    """Return A0 [mm^2] of equal asperities, ``N pi R (3p/(4 N sqrt R))^(2/3)``."""
    return count * np.pi * RADIUS * (3.0 * LOAD / (4.0 * count * np.sqrt(RADIUS))) ** (2.0 / 3.0)


def test_equal_asperities_are_found_in_a_band_around_their_law():
    for count in [1, 4]:
        law = hertz(count)
        found = mf.design(
            mf.Band(LOAD, 0.99 * law, 1.01 * law), LATTICE.only(slice(count)), limits=mf.Limits(0.6)
        )
        assert found.misfit == 0.0
        assert found.status is DesignStatus.EXACT
        # the law is in the inner half of the band to the goal of the search, 6e-4 of the law
        np.testing.assert_allclose(found.target_area, law, rtol=6e-3)
