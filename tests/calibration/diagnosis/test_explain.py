"""Errors of parts that are found from measured laws, and how sure they are."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import metafem as mf
from metafem.calibration import MeasuredLaw, Priors, explain
from metafem.calibration.diagnosis.linearised import Linear
from metafem.calibration.diagnosis.update import update
from tests.calibration.diagnosis.scenes import COMMON, NOTHING, computed, design, measured, scene

ALONE = mf.Independent()


PART, SMALL = design(), design((3, 3))


def test_friction_over_load_alone_converges_where_areas_of_steep_caps_open():
    # the area of such a cap has an infinite slope where it opens
    part = PART.replaced(cap=mf.Power(4, 2.0), block=None)
    elastic = mf.Independent(mf.Elastic())
    for seed in range(2):
        made = part.tilted(1e-3, -1e-3)
        law = measured(made, rng=np.random.default_rng(seed), areas=False, model=elastic)
        found = explain(law, part, COMMON)
        assert not found.notes
        for name, value in (("angle_x", 1e-3), ("angle_y", -1e-3)):
            assert abs(found[name].mean - value) < 3.0 * found[name].sd


def test_an_overlooked_area_wider_than_a_sphere_says_nothing_about_the_gap():
    law = measured(PART)
    wide = np.where(law.asperity_area > 0.0, law.asperity_area_sd, 2.0)
    law = replace(law, asperity_area_sd=wide)
    found = explain(law, PART, COMMON, model=mf.Independent(contact=mf.SphericalCap()))
    assert np.isfinite([cause.mean for cause in found.causes]).all()


def test_areas_in_a_wrong_unit_are_noted():
    law = measured(PART, forces=False)
    areas = {"asperity_area": 100.0 * law.asperity_area, "asperity_area_sd": None}
    notes = explain(replace(law, area=None, area_sd=None, **areas), PART, COMMON, model=ALONE).notes
    assert any("is impossible" in note.text for note in notes)


def test_the_order_of_the_sites_does_not_matter():
    law = measured(PART.tilted(0.001, 0.0005), rng=np.random.default_rng(4))
    order = np.random.default_rng(5).permutation(PART.count)
    moved = PART.replaced(position=PART.position[order], height=PART.height[order])
    given = {"friction_force": law.friction_force, "material": law.material, "friction": law.friction}
    first = explain(law, PART, model=ALONE)
    # the columns of the areas may be in any order, too
    for part, site in ((moved, None), (PART, order)):
        shuffled = MeasuredLaw(law.load, asperity_area=law.asperity_area[:, order], site=site, **given)
        found = explain(shuffled, part, model=ALONE)
        assert found["angle_x"].mean == pytest.approx(first["angle_x"].mean, rel=1e-5)
        heights = first.single["height"].mean[order if site is None else slice(None)]
        np.testing.assert_allclose(found.single["height"].mean, heights, rtol=0.0, atol=1e-8)


def test_a_common_offset_of_the_heights_changes_nothing():
    law = measured(PART, rng=np.random.default_rng(7))
    priors = replace(COMMON, height_scale_sd=0.0)
    first = explain(law, PART, priors, model=ALONE)
    second = explain(law, PART.replaced(height=PART.height + 0.02), priors, model=ALONE)
    np.testing.assert_allclose(
        [cause.mean for cause in second.causes], [cause.mean for cause in first.causes], rtol=1e-5
    )


def test_the_model_of_the_part_is_favoured_and_its_errors_are_found():
    layer = mf.Interacting(substrate=mf.BondedLayer())
    tilted = PART.tilted(math.radians(0.04), 0.0)
    for made, other in ((layer, "independent"), (ALONE, "layer")):
        law = measured(tilted, rng=np.random.default_rng(8), model=made)
        found = explain(law, PART)
        assert found.model == made
        assert found.log_evidence[made.name] > found.log_evidence[other] + 3.0
        assert abs(found["angle_x"].mean - math.radians(0.04)) < 3.0 * found["angle_x"].sd
        assert any(made.name in sentence for sentence in found.sentences())


def test_derivatives_of_interacting_contacts_are_differences_of_the_model():
    one = scene(mf.Interacting(), COMMON, True, SMALL)
    z = np.zeros(one.causes.size)
    at = one.linear(z, np.zeros((len(z), len(z))))
    step = 1e-3
    for name in ("angle_x", "height_scale", "composite_modulus", "friction"):
        other = np.zeros(len(z))
        other[one.causes.where[name]] = step
        difference = (computed(one, other) - computed(one, -other))[: len(at.sd)] / (2.0 * step)
        gradient = at.gradient[:, one.causes.where[name].start] * at.sd
        np.testing.assert_allclose(gradient, difference, rtol=1e-3, atol=1e-4 * np.abs(gradient).max())


@pytest.mark.parametrize("contact", [mf.KogutEtsion(0.8), mf.JKR(9e-6, mf.Elastic())], ids=repr)
def test_derivatives_of_independent_contacts_are_exact(contact):
    caps = mf.Power(1.6), mf.Power(3, 2.0), mf.Sphere(), mf.Profile(lambda rho: rho**2.5, extent=0.5)
    cap = mf.Paraboloid() if contact.plastic else [*caps, *caps, mf.Paraboloid()]
    one = scene(
        mf.Independent(contact=contact), Priors(position_sd=5e-3), False, design((3, 3)).replaced(cap=cap)
    )
    z = 0.3 * np.random.default_rng(0).standard_normal(one.causes.size)
    at = one.linear(z, np.zeros((len(z), len(z))))
    gradient = np.concatenate([at.gradient * at.sd[:, None], at.indentation_gradient])
    for i, other in enumerate(1e-5 * np.eye(len(z))):
        difference = (computed(one, z + other) - computed(one, z - other)) / 2e-5
        np.testing.assert_allclose(gradient[:, i], difference, rtol=1e-4, atol=1e-6 * np.abs(gradient).max())


def test_an_adhesion_energy_that_is_too_large_is_found():
    adhesive = mf.Independent(contact=mf.JKR(9e-6))
    law = measured(SMALL.replaced(height=1.03 * SMALL.height), rng=np.random.default_rng(4), model=adhesive)
    found = explain(law, SMALL, COMMON, model=mf.Independent(contact=mf.JKR(16e-6)))
    for name, value in (("height_scale", 0.03), ("composite_modulus", 0.0), ("adhesion_root", -0.25)):
        assert abs(found[name].mean - value) < 3.0 * found[name].sd


def test_friction_over_load_alone_does_not_tell_modulus_strength_and_height_scale_apart():
    found = explain(measured(PART, rng=np.random.default_rng(6), areas=False), PART, COMMON, model=ALONE)
    named = [set(one.change) for one in found.unresolved]
    assert any({"composite_modulus", "friction"} <= names for names in named)
    assert any("height_scale" in names for names in named)


def test_causes_with_no_prior_are_left_out():
    law = measured(PART)
    found = explain(law, PART, replace(NOTHING, angle_sd=1e-3), model=ALONE)
    assert [cause.name for cause in found.causes] == ["angle_x", "angle_y"]
    assert not found.single
    assert list(found.shares) == ["tilt"]
    assert explain(law, PART, NOTHING, model=ALONE).causes == ()


def test_open_contacts_are_truncated_normal_distributions():
    def truncated(gradient, offset):
        """Return the observations that offset + gradient z is at most 0."""
        none, count = np.zeros(0), len(offset)
        nothing = np.zeros((0, gradient.shape[1]))
        return lambda z, _: Linear(none, nothing, none, offset + gradient @ z, gradient, np.zeros(count))

    for offset in (-3.0, 1.0):
        found = update(truncated(np.array([[1.0]]), np.array([offset])), 1)
        one = stats.truncnorm(-math.inf, -offset)
        assert found.mean[0] == pytest.approx(one.mean(), rel=1e-4, abs=2e-5)
        assert found.covariance[0, 0] == pytest.approx(one.var(), rel=1e-3)
        assert found.log_evidence == pytest.approx(stats.norm.logcdf(-offset), rel=1e-4, abs=1e-4)
    gradient, offset = np.array([[1.0, 0.0], [0.8, 0.6], [-0.3, 0.9]]), np.array([0.5, -0.2, 0.3])
    found = update(truncated(gradient, offset), 2)
    draws = np.random.default_rng(1).standard_normal((400_000, 2))
    kept = draws[(draws @ gradient.T + offset <= 0.0).all(axis=1)]
    sd = kept.std(axis=0)
    np.testing.assert_allclose(found.mean, kept.mean(axis=0), atol=0.03 * sd.max())
    np.testing.assert_allclose(np.sqrt(np.diag(found.covariance)), sd, rtol=0.03)
    assert found.log_evidence == pytest.approx(math.log(len(kept) / len(draws)), abs=0.03)
