"""Robust designs with each option of a design, and where they change the sites alone."""

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus
from tests.core.inversion.test_robustness import LAWS, SOFT, TEMPLATE, TOLERANCES, assert_better

STEPS = mf.Limits(0.12, height_step=0.006)


def test_made_surfaces_on_the_layer_have_a_smaller_expected_misfit():
    assert_better(LAWS["6.87"], mf.Interacting(substrate=mf.BondedLayer()))


def test_designs_are_equal_to_the_bit_and_are_saved(tmp_path):
    first, second = (mf.design(LAWS["9.46"], TEMPLATE, robust=TOLERANCES) for _ in range(2))
    assert first == second
    mf.save(first, tmp_path / "design")
    assert mf.load(tmp_path / "design") == first


@pytest.mark.parametrize(("side", "limits"), [(8, STEPS), (12, None)], ids=["steps", "many"])
def test_heights_on_steps_and_of_many_asperities_change_their_sites_alone(side, limits):
    template = mf.Surface.square_lattice(0.12, (side, side), radius=0.526, material=SOFT)
    plain = mf.design(LAWS["6.87"], template, limits=limits)
    found = mf.design(LAWS["6.87"], template, limits=limits, robust=TOLERANCES)
    np.testing.assert_array_equal(np.sort(found.surface.height), np.sort(plain.surface.height))
    assert found.parameters["robust_gain"] > 0.0
    assert found.surface != plain.surface


def test_points_that_only_exact_heights_meet_are_not_missed():
    points, tall = mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12]), mf.Limits(0.27)
    found = mf.design(points, TEMPLATE, limits=tall, robust=TOLERANCES)
    # levels at which many asperities enter at once are sensitive to their errors
    assert found.parameters["expected_misfit"] < found.parameters["plain_expected_misfit"]
    assert (found.status is DesignStatus.ROBUST) == (found.misfit > 0.01)
    missed = mf.design(mf.PowerLaw(1.2, (0.05, 0.2)), TEMPLATE, limits=mf.Limits(0.05), robust=TOLERANCES)
    assert missed.status is DesignStatus.MISSED


def test_errors_of_radii_and_positions_count():
    small = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=SOFT)
    tolerances = mf.Tolerances(radius_sd=0.01, position_sd=0.02, angle=0.001)
    found = mf.design(mf.PowerLaw(0.9, (0.02, 0.06)), small, robust=tolerances).parameters
    assert 0.0 < found["irreducible_share"] < 1.0
    assert found["expected_misfit"] <= found["plain_expected_misfit"]


def test_best_common_radius_is_made_robust():
    options = {"tools": [0.4, 0.526], "common_radius": True}
    found = mf.design(LAWS["9.46"], TEMPLATE, **options, robust=TOLERANCES)
    assert found.robust == TOLERANCES
    assert found.parameters["robust_gain"] > 0.0
