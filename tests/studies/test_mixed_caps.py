"""Caps that differ, in studies, assignments to sites and calibrations: the right numbers, or a refusal."""

import numpy as np
import pytest

import metafem as mf
from metafem.studies.misalignment import _areas

OWN = mf.Elastic()
CAPS = (mf.Power(4.0), mf.Sphere(), mf.Power(1.5, 0.3), mf.Paraboloid())
LOAD = np.linspace(0.02, 0.2, 8)
MODELS = [mf.Independent(OWN), mf.Interacting(contact=OWN)]


def surface(cap=CAPS, radius=0.5):
    height = np.random.default_rng(0).uniform(0.1, 0.14, 9)
    return mf.Surface.square_lattice(
        height,
        (3, 3),
        1.5,
        radius=radius,
        material=mf.Material(1.36),
        friction=mf.Friction(0.4),
        block=mf.Block(20.0, 20.0, 7.2),
        cap=[cap[i % len(cap)] for i in range(9)] if isinstance(cap, tuple) else cap,
    )


def moved(part, order):
    """The asperities in another order on the same sites, each with its own cap."""
    return mf.Surface(
        part.position,
        part.height[order],
        part.radius[order],
        part.material,
        friction=part.friction,
        block=part.block,
        cap=[part.cap.one(int(i)) for i in order],
    )


@pytest.mark.parametrize("model", MODELS, ids=lambda model: model.name)
def test_assignments_of_the_misalignment_study_move_the_caps(model):
    part, angle = surface(radius=np.linspace(0.4, 0.6, 9)), np.array([-0.001, 0.0, 0.001])
    order = np.random.default_rng(2).permutation(9)
    tilt = np.outer(np.tan(angle), [1.0, 0.0])
    found = _areas(part, model, tilt, LOAD, order)
    for row, each in zip(found, angle, strict=True):
        tilted = moved(part, order).tilted(float(each), 0.0)
        np.testing.assert_allclose(row, model.curve(tilted, LOAD).area, rtol=1e-10)


def test_perturbed_surfaces_keep_their_caps():
    part, model = surface(), mf.Interacting(contact=OWN)
    tolerances = mf.Tolerances(height_sd=0.001, position_sd=0.01, radius_sd=0.01)
    height, radius, position = tolerances.perturbed(part, 3, np.random.default_rng(3))
    found = model.areas(part, LOAD, height, radius, position)
    for row in range(3):
        made = part.replaced(height=height[row], radius=radius[row], position=position[row])
        np.testing.assert_allclose(found[row], model.curve(made, LOAD).area, rtol=1e-11)


def test_the_plasticity_index_uses_the_curvature_of_the_summits():
    part, plain = surface(mf.Power(2.0, 0.25)), surface(mf.Sphere(), radius=1.0)
    assert mf.plasticity_index(part, 10.0) == mf.plasticity_index(plain, 10.0)
