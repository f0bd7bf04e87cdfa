"""Known errors of a part are found from its measured law."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import MeasuredLaw, Priors, explain
from tests.calibration.diagnosis.scenes import COMMON, LOADS, NOTHING, design, measured

PART = design()
ALONE = mf.Independent()


def test_a_tilted_part_is_recognised_as_tilted():
    tilted = PART.tilted(math.radians(0.08), math.radians(-0.05))
    found = explain(measured(tilted, rng=np.random.default_rng(1)), PART, model=ALONE)
    assert next(iter(found.shares)) == "tilt"
    assert found.shares["tilt"] > 0.7
    for name, angle in (("angle_x", 0.08), ("angle_y", -0.05)):
        assert abs(found[name].mean - math.radians(angle)) < 3.0 * found[name].sd
        assert found[name].sd < 0.2 * found[name].prior_sd
    assert found.verdict.fits
    assert not found.outliers.size
    assert "explained by tilt (" in found.sentences()[1]


def test_a_scaled_part_is_recognised_as_scaled():
    scaled = PART.replaced(height=1.05 * PART.height)
    found = explain(measured(scaled, rng=np.random.default_rng(2)), PART, model=ALONE)
    assert next(iter(found.shares)) == "height_scale"
    assert found.shares["height_scale"] > 0.6
    assert abs(found["height_scale"].mean - 0.05) < 3.0 * found["height_scale"].sd


KINDS = {
    "steep": mf.Power(4, 2.0),
    "blunt": mf.Power(1.5),
    "mixed": [
        [mf.Power(1.6), mf.Power(3, 2.0), mf.Sphere(), mf.Power(2.5)][i % 4] for i in range(PART.count)
    ],
}


@pytest.mark.parametrize("kind", KINDS)
def test_the_causes_are_found_whatever_the_caps(kind):
    part = PART.replaced(cap=KINDS[kind])
    made = part.replaced(height=1.04 * part.height).tilted(math.radians(0.08), 0.0)
    truth = {
        "angle_x": math.radians(0.08),
        "height_scale": 0.04,
        "composite_modulus": 0.05,
        "friction": -0.03,
    }
    law = measured(
        made, rng=np.random.default_rng(9), stiffer=1.05, friction=0.97, model=mf.Independent(mf.Elastic())
    )
    # the law of the caps is that of their profiles by default
    found = explain(replace(law, material=part.material), part.replaced(block=None))
    assert found.model == mf.Independent(mf.Elastic())
    for name, value in truth.items():
        assert abs(found[name].mean - value) < 3.0 * found[name].sd
    assert found["angle_x"].sd < 0.2 * found["angle_x"].prior_sd
    assert found.verdict.fits
    assert not found.notes


def test_one_asperity_of_mixed_caps_that_is_too_low_is_found():
    part = PART.replaced(cap=KINDS["mixed"], block=None)
    height = part.height.copy()
    site = int(height.argmax())
    height[site] -= 0.015
    law = measured(
        part.replaced(height=height), rng=np.random.default_rng(3), model=mf.Independent(mf.Elastic())
    )
    found = explain(law, part)
    assert found.outliers.tolist() == [site]
    assert abs(found.single["height"].mean[site] + 0.015) < 3.0 * found.single["height"].sd[site]


def test_friction_over_load_alone_converges_where_areas_of_steep_caps_open():
    # the area of such a cap has an infinite slope where it opens
    part = PART.replaced(cap=KINDS["steep"], block=None)
    elastic = mf.Independent(mf.Elastic())
    for seed in range(4):
        made = part.tilted(1e-3, -1e-3)
        law = measured(made, rng=np.random.default_rng(seed), areas=False, model=elastic)
        found = explain(law, part, COMMON)
        assert not found.notes
        for name, value in (("angle_x", 1e-3), ("angle_y", -1e-3)):
            assert abs(found[name].mean - value) < 3.0 * found[name].sd


def test_an_adhesive_part_is_explained_with_the_contact_law_of_its_design():
    adhesive = mf.Independent(contact=mf.JKR(9e-6))
    law = measured(PART.replaced(height=1.03 * PART.height), rng=np.random.default_rng(4), model=adhesive)
    found = explain(law, PART, model=adhesive)
    for name, value in (("height_scale", 0.03), ("composite_modulus", 0.0), ("friction", 0.0)):
        assert abs(found[name].mean - value) < 3.0 * found[name].sd
    assert found.verdict.fits
    # Hertz contacts have smaller areas at the same loads
    hertz = explain(law, PART, model=ALONE)
    assert hertz["composite_modulus"].mean < -0.03
    assert found.log_evidence[adhesive.name] > hertz.log_evidence["independent"]
    # an adhesion energy of the calibration that is too large is found
    found = explain(law, PART, model=mf.Independent(contact=mf.JKR(16e-6)))
    for name, value in (("height_scale", 0.03), ("composite_modulus", 0.0), ("adhesion_root", -0.25)):
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
    assert any("is impossible" in note.text and "check the units" in note.text for note in notes)


def test_one_deep_hole_is_that_hole():
    height = PART.height.copy()
    site = int(height.argmax())
    height[site] -= 0.015
    found = explain(measured(PART.replaced(height=height), rng=np.random.default_rng(3)), PART, model=ALONE)
    assert found.outliers.tolist() == [site]
    errors = found.single["height"]
    assert abs(errors.mean[site] + 0.015) < 3.0 * errors.sd[site]
    assert any(f"Asperity {site} is" in sentence and "lower" in sentence for sentence in found.sentences())
    assert abs(found["angle_x"].mean) < 3.0 * found["angle_x"].sd


def test_measured_values_without_information_give_the_prior_back():
    law = measured(PART.tilted(0.001, 0.0))
    vague = MeasuredLaw(
        law.load, friction_force=law.friction_force, friction_force_sd=np.full(len(LOADS), 1e6),
        load_sd=np.full(len(LOADS), 1e-6), material=law.material, friction=law.friction,
    )  # fmt: skip
    found = explain(vague, PART, model=ALONE)
    for cause in found.causes:
        assert cause.mean == pytest.approx(0.0, abs=1e-6 * cause.prior_sd)
        assert cause.sd == pytest.approx(cause.prior_sd, rel=1e-6)
    assert len(found.unresolved) == len(found.causes)


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


def test_friction_over_load_alone_does_not_tell_modulus_strength_and_height_scale_apart():
    found = explain(measured(PART, rng=np.random.default_rng(6), areas=False), PART, COMMON, model=ALONE)
    named = [set(one.change) for one in found.unresolved]
    assert any({"composite_modulus", "friction"} <= names for names in named)
    assert any("height_scale" in names for names in named)
    assert any("apart: " in sentence for sentence in found.sentences())


def test_a_common_offset_of_the_heights_changes_nothing():
    law = measured(PART, rng=np.random.default_rng(7))
    priors = replace(COMMON, height_scale_sd=0.0)
    first = explain(law, PART, priors, model=ALONE)
    second = explain(law, PART.replaced(height=PART.height + 0.02), priors, model=ALONE)
    np.testing.assert_allclose(
        [cause.mean for cause in second.causes], [cause.mean for cause in first.causes], rtol=1e-5
    )


def test_causes_with_no_prior_are_left_out():
    law = measured(PART)
    found = explain(law, PART, replace(NOTHING, angle_sd=1e-3), model=ALONE)
    assert [cause.name for cause in found.causes] == ["angle_x", "angle_y"]
    assert not found.single
    assert list(found.shares) == ["tilt"]
    assert explain(law, PART, NOTHING, model=ALONE).causes == ()


@pytest.mark.slow
def test_the_model_of_the_part_is_favoured_and_its_errors_are_found():
    layer = mf.Interacting(substrate=mf.BondedLayer())
    tilted = PART.tilted(math.radians(0.04), 0.0)
    for made, other in ((layer, "independent"), (ALONE, "layer")):
        law = measured(tilted, rng=np.random.default_rng(8), model=made)
        found = explain(law, PART)
        assert found.model == made
        assert found.log_evidence[made.name] > found.log_evidence[other] + 3.0
        assert abs(found["angle_x"].mean - math.radians(0.04)) < 3.0 * found["angle_x"].sd
        assert any(f"favour the model {made.name}" in sentence for sentence in found.sentences())


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda law: explain(1, PART), "measured = 1"),
        (lambda law: explain(law, 1), "design = 1"),
        (lambda law: explain(law, PART, 1), "priors = 1"),
        (lambda law: explain(law, design((2, 2))), "names asperity 24; the design has 4"),
        (lambda law: Priors(angle_sd=-1.0), "angle_sd"),
        (lambda law: Priors(friction_sd=0.5), "friction_sd"),
    ],
)
def test_bad_input_is_named(call, message):
    with pytest.raises(mf.InvalidInput, match=message):
        call(measured(PART))
