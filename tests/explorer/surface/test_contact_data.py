"""The contacts of a surface at one load, and the sensitivity of the law to each height there."""

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.surface.contact_data import contact_data
from metafem.files import demo_text, parsed

LOAD = 0.3


@pytest.fixture(scope="module")
def design():
    return parsed(demo_text("operating-points"), {}).design()


def by_asperity(design, values):
    return np.array([values[site] for site in design.sites])


def test_the_contacts_are_those_of_hertz(design):
    data = contact_data(design, LOAD)
    surface, modulus = design.surface, design.surface.material.composite_modulus
    radius, force = by_asperity(design, data["radius"]), by_asperity(design, data["force"])
    indentation = np.maximum(surface.height - data["separation"] / 1e3, 0.0)
    # half of the last decimal that is sent
    np.testing.assert_allclose(radius, np.sqrt(surface.radius * indentation), atol=5e-5)
    assert force.sum() / 1e3 == pytest.approx(LOAD * modulus, abs=len(force) * 5e-7)
    pressure = by_asperity(design, data["pressure"])
    # p = 4 E* a / (3 pi R)
    np.testing.assert_allclose(pressure, 4.0 * modulus * radius / (3.0 * np.pi * surface.radius), atol=2e-4)
    assert data["load"] == pytest.approx(LOAD, rel=1e-9)
    assert "problem" not in data


def test_the_default_load_is_the_largest_of_the_law(design):
    assert contact_data(design, None)["load"] == pytest.approx(design.law.rescaled_load[-1], rel=1e-9)


@pytest.mark.parametrize("model", [mf.Independent(), mf.Interacting(substrate=mf.BondedLayer())])
def test_the_sensitivity_is_that_of_the_friction(design, model):
    layered = mf.design(design.target, design.template, model, design.limits) if model.couples else design
    data = contact_data(layered, LOAD, sensitive=True)
    found = by_asperity(layered, data["sensitivity"])
    surface, i = layered.surface, int(np.argmax(layered.surface.height))
    step, load = 1e-4, LOAD * surface.material.composite_modulus
    area = []
    for sign in (-1.0, 1.0):
        height = surface.height.copy()
        height[i] += sign * step
        area.append(mf.equilibrium(surface.replaced(height=height), model, load=load).area)
    expected = 100.0 * (area[1] - area[0]) / (2e3 * step) / np.mean(area)
    # central differences are off by the square of the step
    assert found[i] == pytest.approx(expected, rel=1e-3)
    assert data["note"] == ""


def test_a_model_without_derivatives_says_whose_it_shows(design):
    from dataclasses import replace

    law = mf.friction_law(design.surface, mf.Automatic(tolerance=0.1), load=[0.1])
    data = contact_data(replace(design, law=law), LOAD, sensitive=True)
    assert data["note"].startswith("Sensitivities are those of the model ")
