"""Known errors of a part are found from its measured law."""

import math

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import MeasuredLaw, MeasurementErrors, explain

MATERIAL, FRICTION = mf.Material(1.36), mf.Friction(0.404, 0.85)
LOADS, ERRORS = np.linspace(0.02, 0.6, 12), MeasurementErrors()


def design(shape=(5, 5)):
    height = np.random.default_rng(0).uniform(0.05, 0.12, shape[0] * shape[1])
    given = {"material": MATERIAL, "friction": FRICTION}
    return mf.Surface.square_lattice(height, shape, 1.5, radius=0.526, **given)


def measured(made, rng=None, stiffer=1.0, friction=1.0, forces=True, areas=True, model=None):
    """Return the measured law of a part; its E* and sigma B are those of the design times these factors."""
    made = made.replaced(material=mf.Material(1.36 * stiffer))
    states = [mf.equilibrium(made, model, load=load) for load in LOADS]
    area = np.array([state.asperity_area for state in states])
    force, load = friction * FRICTION.stress * area.sum(axis=1), LOADS
    if rng is not None:
        load = load + ERRORS.load * rng.standard_normal(load.shape)
        force = force + ERRORS.of_friction_force(force) * rng.standard_normal(force.shape)
        area = np.maximum(area + ERRORS.of_area(area) * rng.standard_normal(area.shape), 0.0)
    return MeasuredLaw(
        load,
        friction_force=force if forces else None,
        asperity_area=area if areas else None,
        material=MATERIAL,
        friction=FRICTION,
    )


PART = design()


def scores(found, **true):
    return [(found.mean[name] - value) / found.sd[name] for name, value in true.items()]


@pytest.mark.parametrize("first", [0, pytest.param(4, marks=pytest.mark.slow)])
def test_the_errors_of_a_part_are_found_within_their_standard_deviations(first):
    true = {"angle_x": 1.4e-3, "angle_y": -9e-4, "height_scale": 0.03, "composite_modulus": 0.05}
    true["friction"] = -0.03
    off = []
    for seed in range(first, first + 4):
        rng = np.random.default_rng(seed)
        made = PART.replaced(height=1.03 * PART.height).tilted(1.4e-3, -9e-4).perturbed(0.9e-3, rng)
        found = explain(measured(made, rng, stiffer=1.05, friction=0.97), PART)
        assert found.verdict.fits
        # the errors of the boundaries, loads and heights are some percent of the areas
        assert 0.01 < found.deviation < 0.05
        off += scores(found, **true)
    # 20 values of s.d. 1: their rms within three of its standard errors, 1/sqrt(40)
    assert np.sqrt(np.mean(np.square(off))) < 1.0 + 3.0 / math.sqrt(40)
    assert 0.005 * found.expected["angle_x"] < found.sd["angle_x"] < 0.2 * found.expected["angle_x"]
    assert "tilt along x: +0.0" in repr(found)


def test_areas_alone_find_a_tilt():
    law = measured(PART.tilted(1.5e-3, 0.0), forces=False)
    found = explain(law, PART)
    assert list(found.mean) == ["angle_x", "angle_y", "height_scale", "composite_modulus"]
    assert found.mean["angle_x"] == pytest.approx(1.5e-3, rel=0.05)


def test_interacting_contacts_are_explained_under_their_model():
    small, model = design((3, 3)), mf.Interacting()
    found = explain(measured(small.tilted(1e-3, 0.0), model=model), small, model=model)
    assert found.mean["angle_x"] == pytest.approx(1e-3, abs=found.sd["angle_x"])
    assert found.verdict.chi_square < 2.0


def test_values_without_information_give_the_expected_errors_back():
    law = measured(PART, areas=False)
    vague = MeasuredLaw(
        law.load, friction_force=law.friction_force, friction_force_sd=np.full(len(LOADS), 1e6),
        material=law.material, friction=law.friction,
    )  # fmt: skip
    found = explain(vague, PART)
    for name, sd in found.expected.items():
        assert found.mean[name] == pytest.approx(0.0, abs=1e-6 * sd)
        assert found.sd[name] == pytest.approx(sd, rel=1e-6)


def test_the_order_of_the_sites_does_not_matter():
    law = measured(PART.tilted(0.001, 0.0005), rng=np.random.default_rng(4))
    order = np.random.default_rng(5).permutation(PART.count)
    given = {"friction_force": law.friction_force, "material": law.material, "friction": law.friction}
    shuffled = MeasuredLaw(law.load, asperity_area=law.asperity_area[:, order], site=order, **given)
    first, second = explain(law, PART), explain(shuffled, PART)
    assert second.mean["angle_x"] == pytest.approx(first.mean["angle_x"], rel=1e-5)
