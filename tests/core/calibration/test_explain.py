"""Known errors of a part are found from its measured law; derivatives, updates and shares are exact."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import metafem as mf
from metafem.calibration import MeasuredLaw, Priors, explain
from metafem.calibration.diagnosis.sensitivities import response
from metafem.calibration.diagnosis.sentences import ranking
from metafem.calibration.diagnosis.update import update
from tests.calibration.diagnosis.scenes import (
    COMMON,
    LOADS,
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
