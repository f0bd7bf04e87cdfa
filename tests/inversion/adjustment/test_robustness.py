"""Robust designs: closed forms, gains on other draws, and where there is none."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.inversion import DesignStatus
from tests.inversion.test_design import deepest_call

SOFT = mf.Material(1.36, 0.5)
BLOCK = mf.Block(20.0, 20.0, 7.2)
TEMPLATE = mf.Surface.square_lattice(0.12, radius=0.526, material=SOFT, block=BLOCK)
LAYER = mf.Interacting(substrate=mf.BondedLayer())
# the source paper's heights have a scatter of about 3 um
TOLERANCES = mf.Tolerances(height_sd=0.003, angle=math.radians(0.05))
LAWS = {"6.87": mf.LinearLaw(6.87), "9.46": mf.LinearLaw(9.46), "power": mf.PowerLaw(1.1, (0.05, 0.2))}


def expected(design, rng, draws=1000):
    """Squared misfits of made surfaces, by errors that are drawn here; the mean of both signs, (m,)."""
    surface, law, random = design.surface, design.target_law, np.random.default_rng(rng)
    error = 0.003 * random.standard_normal((draws, surface.count))
    error = error + np.tan(random.uniform(-1, 1, (draws, 2)) * math.radians(0.05)) @ surface.position.T
    height = surface.height + np.concatenate([error, -error])
    area = design.law.model.areas(surface, law.load, height)
    return np.array([law.misfit(row) ** 2 for row in area]).reshape(2, -1).mean(axis=0)


@pytest.mark.slow
@pytest.mark.parametrize("law", ["6.87", "power"])
def test_made_surfaces_on_the_layer_have_a_smaller_expected_misfit(law):
    plain = mf.design(LAWS[law], TEMPLATE, LAYER)
    robust = mf.design(LAWS[law], TEMPLATE, LAYER, robust=TOLERANCES)
    gain = expected(plain, 99) - expected(robust, 99)
    assert gain.mean() > 3.0 * gain.std(ddof=1) / math.sqrt(len(gain))


def test_designs_are_equal_to_the_bit_and_are_saved(tmp_path):
    first, second = (mf.design(LAWS["9.46"], TEMPLATE, robust=TOLERANCES) for _ in range(2))
    assert first == second
    mf.save(first, tmp_path / "design")
    assert mf.load(tmp_path / "design") == first


def test_heights_stay_on_their_steps_and_levels():
    limits = mf.Limits(0.12, height_step=0.006)
    found = mf.design(LAWS["6.87"], TEMPLATE, limits=limits, robust=TOLERANCES)
    plain = mf.design(LAWS["6.87"], TEMPLATE, limits=limits)
    # the numbers on the levels are those of the density, and only the sites are other ones
    np.testing.assert_array_equal(np.sort(found.surface.height), np.sort(plain.surface.height))
    assert found.parameters["robust_gain"] > 0.0
    assert found.surface != plain.surface


def test_heights_of_many_asperities_change_their_sites_alone():
    large = mf.Surface.square_lattice(0.12, (12, 12), radius=0.526, material=SOFT)
    target = mf.LinearLaw(6.87)
    plain, found = mf.design(target, large), mf.design(target, large, robust=TOLERANCES)
    np.testing.assert_array_equal(np.sort(found.surface.height), np.sort(plain.surface.height))
    assert found.parameters["robust_gain"] > 3.0 * found.parameters["robust_gain_error"]


def test_points_that_only_exact_heights_meet_are_not_missed():
    points = mf.OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12])
    found = mf.design(points, TEMPLATE, limits=mf.Limits(0.27), robust=TOLERANCES)
    # levels at which many asperities enter at once are sensitive to their errors
    assert found.parameters["expected_misfit"] < 0.5 * found.parameters["plain_expected_misfit"]
    assert found.misfit > 0.01
    assert found.status is DesignStatus.ROBUST
    far = mf.Limits(0.05)
    missed = mf.design(mf.PowerLaw(1.2, (0.05, 0.2)), TEMPLATE, limits=far, robust=TOLERANCES)
    assert missed.status is DesignStatus.MISSED


def test_errors_of_radii_and_positions_count():
    small = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=SOFT)
    target = mf.PowerLaw(0.9, (0.02, 0.06))
    tolerances = mf.Tolerances(radius_sd=0.01, position_sd=0.02, angle=0.001)
    found = mf.design(target, small, robust=tolerances).parameters
    assert 0.0 < found["irreducible_share"] < 1.0
    assert found["expected_misfit"] <= found["plain_expected_misfit"]


def test_best_common_radius_is_made_robust():
    tools = [0.4, 0.526]
    found = mf.design(LAWS["9.46"], TEMPLATE, tools=tools, common_radius=True, robust=TOLERANCES)
    assert found.robust == TOLERANCES
    assert found.parameters["robust_gain"] > 0.0


@pytest.mark.slow
def test_a_kernel_is_called_within_ten_frames(monkeypatch):
    small = mf.Surface.square_lattice(0.27, (2, 2), radius=0.526, material=SOFT)
    target, limits = mf.PowerLaw(0.9, (0.02, 0.06)), mf.Limits(0.27, height_step=0.006)
    model = mf.Interacting(order=1)
    assert 0 < deepest_call(monkeypatch, target, small, model, limits, robust=TOLERANCES) <= 10
