"""Known errors of a part are found from its measured law; derivatives, updates and shares are exact."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import metafem as mf
from metafem.calibration import MeasuredLaw, Priors, explain
from metafem.calibration.diagnosis.linearised import Linear
from metafem.calibration.diagnosis.sensitivities import response
from metafem.calibration.diagnosis.sentences import ranking
from metafem.calibration.diagnosis.update import update
from tests.calibration.diagnosis.scenes import (
    COMMON,
    LOADS,
    NOTHING,
    computed,
    design,
    exact,
    gaussian,
    measured,
    scene,
)

PART, SMALL = design(), design((3, 3))
ALONE = mf.Independent()
MIXED = [[mf.Power(1.6), mf.Power(3, 2.0), mf.Sphere(), mf.Power(2.5)][i % 4] for i in range(PART.count)]
STEEP = mf.Profile(lambda rho: rho**2.5, extent=0.5)


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
    assert "tilt (" in found.sentences()[1]


def test_the_causes_are_found_with_mixed_caps():
    part = PART.replaced(cap=MIXED)
    made = part.replaced(height=1.04 * part.height).tilted(math.radians(0.08), 0.0)
    truth = {
        "angle_x": math.radians(0.08),
        "height_scale": 0.04,
        "composite_modulus": 0.05,
        "friction": -0.03,
    }
    elastic = mf.Independent(mf.Elastic())
    law = measured(made, rng=np.random.default_rng(9), stiffer=1.05, friction=0.97, model=elastic)
    # the law of the caps is that of their profiles by default
    found = explain(replace(law, material=part.material), part.replaced(block=None))
    assert found.model == elastic
    for name, value in truth.items():
        assert abs(found[name].mean - value) < 3.0 * found[name].sd
    assert found["angle_x"].sd < 0.2 * found["angle_x"].prior_sd
    assert found.verdict.fits
    assert not found.notes


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


def test_shares_add_up_and_the_misfit_without_a_cause_is_that_of_an_explanation_without_it():
    law = measured(SMALL, stiffer=1.05, rng=np.random.default_rng(1))
    found = explain(law, SMALL, COMMON, model=ALONE)
    other = explain(law, SMALL, replace(COMMON, composite_modulus_sd=0.0), model=ALONE)
    assert found.misfit_without["composite_modulus"] == pytest.approx(other.misfit, rel=0.05)
    assert all(value >= found.misfit for value in found.misfit_without.values())
    assert sum(found.shares.values()) == pytest.approx(1.0)
    # the misfit is that of the values and of the errors over their priors
    squares = sum(float(np.nansum(values**2)) for values in found.residual.values())
    squares += sum((cause.mean / cause.prior_sd) ** 2 for cause in found.causes)
    assert found.misfit == pytest.approx(squares, rel=0.02)
    first, second = ranking({"radius": 0.95, "composite_modulus": 0.25, "friction": -0.2})
    assert ("95 %" in first, "25 %" in first, "-20 %" in second) == (True, True, True)


@pytest.mark.parametrize(
    ("contact", "cap", "areas"),
    [
        (mf.Hertz(), mf.Paraboloid(), True),
        (mf.JKR(9e-6), mf.Paraboloid(), False),
        (mf.Elastic(), MIXED[:9], True),
        pytest.param(mf.KogutEtsion(0.8), mf.Paraboloid(), False, marks=pytest.mark.slow),
        pytest.param(mf.JKR(9e-6, mf.Elastic()), [*MIXED[:8], STEEP], False, marks=pytest.mark.slow),
    ],
)
def test_derivatives_of_independent_contacts_are_exact(contact, cap, areas):
    one = scene(mf.Independent(contact=contact), Priors(position_sd=5e-3), areas, SMALL.replaced(cap=cap))
    z = 0.3 * np.random.default_rng(0).standard_normal(one.causes.size)
    at = one.linear(z, np.zeros((len(z), len(z))))
    gradient = np.concatenate([at.gradient * at.sd[:, None], at.indentation_gradient])
    for i, other in enumerate(1e-5 * np.eye(len(z))):
        difference = (computed(one, z + other) - computed(one, z - other)) / 2e-5
        np.testing.assert_allclose(gradient[:, i], difference, rtol=1e-4, atol=1e-6 * np.abs(gradient).max())


def test_areas_of_all_models_are_those_of_their_states():
    load = np.array([0.02, 0.2])
    for model in (mf.Independent(mf.SphericalCap()), mf.Interacting()):
        found = response(model, exact(SMALL), load)
        for area, value in zip(found.area, load, strict=True):
            state = mf.equilibrium(SMALL, model, load=value * SMALL.material.composite_modulus)
            np.testing.assert_allclose(np.maximum(area, 0.0), state.asperity_area, rtol=1e-9, atol=1e-12)
        assert (found.area[0] < 0.0).any()  # open contacts have a gap


def test_a_light_load_of_one_contact_follows_hertz():
    load = np.array([1e-3])
    one = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material(1.0))
    found = response(ALONE, exact(one), load)
    area = np.pi * (0.75 * 0.5 * load[0]) ** (2.0 / 3.0)
    assert found.area[0, 0] == pytest.approx(area, rel=1e-10)
    assert found.by_load()[0, 0] == pytest.approx(2.0 / 3.0 * area / load[0], rel=1e-10)
    assert found.by_each_radius()[0, 0, 0] == pytest.approx(2.0 / 3.0 * area / 0.5, rel=1e-10)
    assert found.by_each_height()[0, 0, 0] == pytest.approx(0.0, abs=1e-12)


def test_linear_observations_give_the_dense_gaussian_formula():
    rng = np.random.default_rng(0)
    matrix, sd = rng.standard_normal((12, 5)), rng.uniform(0.5, 2.0, 12)
    data = rng.standard_normal(12)
    found = update(gaussian(matrix, data, sd), 5)
    of_data = np.diag(sd**2) + matrix @ matrix.T
    gain = matrix.T @ np.linalg.inv(of_data)
    np.testing.assert_allclose(found.mean, gain @ data, rtol=1e-10)
    np.testing.assert_allclose(found.covariance, np.eye(5) - gain @ matrix, atol=1e-12)
    evidence = stats.multivariate_normal(np.zeros(12), of_data).logpdf(data)
    assert found.log_evidence == pytest.approx(evidence, rel=1e-10)


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


def test_an_adhesion_energy_that_is_too_large_is_found():
    adhesive = mf.Independent(contact=mf.JKR(9e-6))
    law = measured(SMALL.replaced(height=1.03 * SMALL.height), rng=np.random.default_rng(4), model=adhesive)
    found = explain(law, SMALL, COMMON, model=mf.Independent(contact=mf.JKR(16e-6)))
    for name, value in (("height_scale", 0.03), ("composite_modulus", 0.0), ("adhesion_root", -0.25)):
        assert abs(found[name].mean - value) < 3.0 * found[name].sd


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
