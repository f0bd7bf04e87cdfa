"""Derivatives of the measured values by all errors, against differences."""

from __future__ import annotations

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import Priors
from metafem.calibration.diagnosis.causes import Causes, Made
from metafem.calibration.diagnosis.linearised import Scene
from metafem.calibration.diagnosis.sensitivities import response
from metafem.models.model import contact_of
from tests.calibration.diagnosis.scenes import COMMON, NOTHING, design, measured

PART = design((3, 3))


# The areas of profiles do not depend on the radius.
FOUR = mf.Power(1.6), mf.Power(3, 2.0), mf.Sphere(), mf.Profile(lambda rho: rho**2.5, extent=0.5)
MIXED = PART.replaced(cap=[*FOUR, *FOUR, mf.Paraboloid()])


def scene(model: mf.Model, priors: Priors, areas: bool = True, part: mf.Surface = PART) -> Scene:
    """Return the part with its measured values without noise."""
    law = measured(part, areas=areas, model=None if part is PART else model)
    adhesive = contact_of(model).adhesive
    causes = Causes.of(part, law.load, law.load_sd, priors, True, adhesive)
    return Scene(model, causes, law, part.friction)


def exact(surface: mf.Surface) -> Made:
    """Return a part without errors."""
    return Causes.of(surface, np.ones(1), np.ones(1), NOTHING, False).made(np.zeros(1))


def computed(scene: Scene, z: np.ndarray) -> np.ndarray:
    """Return the measured values less the residuals."""
    at = scene.linear(z, np.zeros((len(z), len(z))))
    return np.concatenate([-at.residual * at.sd, at.indentation])


@pytest.mark.parametrize(
    ("contact", "part"),
    [
        (mf.Hertz(), PART),
        (mf.SphericalCap(), PART),
        (mf.JKR(9e-6), PART),
        (mf.KogutEtsion(0.8), PART),
        (mf.Elastic(), MIXED),
        (mf.JKR(9e-6, mf.Elastic()), MIXED),
    ],
    ids=["Hertz", "spheres", "JKR", "Kogut-Etsion", "mixed caps", "adhesive mixed caps"],
)
@pytest.mark.parametrize("areas", [True, False])
def test_derivatives_of_independent_contacts_are_exact(contact, part, areas):
    one = scene(mf.Independent(contact=contact), Priors(position_sd=5e-3), areas, part)
    z = 0.3 * np.random.default_rng(0).standard_normal(one.causes.size)
    at = one.linear(z, np.zeros((len(z), len(z))))
    gradient = np.concatenate([at.gradient * at.sd[:, None], at.indentation_gradient])
    step = 1e-5
    for i in range(len(z)):
        other = step * np.eye(len(z))[i]
        difference = (computed(one, z + other) - computed(one, z - other)) / (2.0 * step)
        np.testing.assert_allclose(gradient[:, i], difference, rtol=1e-4, atol=1e-6 * np.abs(gradient).max())


def test_derivatives_of_interacting_contacts_are_differences_of_the_model():
    one = scene(mf.Interacting(), COMMON)
    z = np.zeros(one.causes.size)
    at = one.linear(z, np.zeros((len(z), len(z))))
    step = 1e-3
    for name in ("angle_x", "height_scale", "composite_modulus", "friction"):
        other = np.zeros(len(z))
        other[one.causes.where[name]] = step
        difference = (computed(one, other) - computed(one, -other))[: len(at.sd)] / (2.0 * step)
        gradient = at.gradient[:, one.causes.where[name].start] * at.sd
        np.testing.assert_allclose(gradient, difference, rtol=1e-3, atol=1e-4 * np.abs(gradient).max())


@pytest.mark.parametrize("model", [mf.Independent(mf.SphericalCap()), mf.Interacting(), mf.MeanField()])
def test_areas_of_all_models_are_those_of_their_states(model):
    load = np.array([0.02, 0.2])
    found = response(model, exact(PART), load)
    for k, value in enumerate(load):
        state = mf.equilibrium(PART, model, load=value * PART.material.composite_modulus)
        np.testing.assert_allclose(np.maximum(found.area[k], 0.0), state.asperity_area, rtol=1e-9, atol=1e-12)
    assert (found.area[0] < 0.0).any()  # open contacts have a gap


def test_a_light_load_of_one_contact_follows_hertz():
    load = np.array([1e-3])
    one = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material(1.0))
    found = response(mf.Independent(), exact(one), load)
    area = np.pi * (0.75 * 0.5 * load[0]) ** (2.0 / 3.0)
    assert found.area[0, 0] == pytest.approx(area, rel=1e-10)
    assert found.by_load()[0, 0] == pytest.approx(2.0 / 3.0 * area / load[0], rel=1e-10)
    assert found.by_each_radius()[0, 0, 0] == pytest.approx(2.0 / 3.0 * area / 0.5, rel=1e-10)
    assert found.by_each_height()[0, 0, 0] == pytest.approx(0.0, abs=1e-12)
