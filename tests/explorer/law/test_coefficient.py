"""A friction coefficient: F/P over a range of loads, carried by its handle, and the largest one."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import _advised, answered
from metafem.explorer.law.law_data import law_data
from metafem.explorer.law.nearest import offer, with_nearest
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.explorer.text.kinds import with_kind
from metafem.explorer.workshop.changes import with_choice
from metafem.files import demo_text
from metafem.inversion import DesignStatus

TEXT = demo_text("operating-points")
LOADS = ["0.1 N", "0.9 N"]


@pytest.fixture(scope="module")
def first():
    return answered(State(TEXT), 0)


def line(**values):
    return Document(TEXT).with_kind("target", "linear", values)


def coefficients(answer):
    """Return F/P of the achieved law within its load range."""
    law, (low, high) = answer.design.law, answer.specification.target.load_range
    rows = (law.rescaled_load >= low) & (law.rescaled_load <= high)
    return (law.friction_force / law.load)[rows]


def test_a_coefficient_in_place_of_a_slope_is_the_ratio_over_a_range_of_loads(first):
    text = line(slope=6.5)
    forces = with_choice(text, "target", 1, answered(State(text), 1).specification)
    found = answered(State(forces), 2, first)
    mu = Document(forces).value("target.friction_coefficient")
    np.testing.assert_allclose(coefficients(found), mu, rtol=0.01)


def test_a_coefficient_from_another_law_has_its_loads(first):
    forces = with_choice(TEXT, "target", 1, first.specification)
    found = answered(State(with_kind(State(forces), first.design, "linear")), 2, first)
    assert found.current
    np.testing.assert_allclose(
        coefficients(found).mean(),
        found.specification.target.wording.coefficient(found.specification.target.slope),
        rtol=0.01,
    )


def test_the_handle_carries_the_coefficient(first):
    found = answered(State(line(friction_coefficient=1.5, load_range=LOADS)), 1, first)
    assert law_data(found)["handles"][0]["carried"] == "μ = 1.5"
    assert law_data(answered(State(line(slope=6.5)), 1, first))["handles"][0]["carried"] == "slope = 6.5"


@pytest.mark.parametrize("values", [{"friction_coefficient": 20.0}, {"slope": 40.0}])
def test_an_impossible_coefficient_without_loads_names_the_largest_that_is_met(first, values):
    found = answered(State(line(**values)), 1, first)
    assert not found.refusal
    words = offer(found).removeprefix("Use ")
    assert words.startswith(found.nearest_target.wording.name())
    assert "is not met. The largest over the loads that are reached, " in found.advice
    assert found.advice.endswith(f"is {words}")
    assert law_data(found)["advice"] == found.advice
    used = answered(State(with_nearest(found)), 2, found)
    assert used.design.status is not DesignStatus.MISSED
    assert used.advice == ""


def test_advice_from_a_simpler_model_says_so(first):
    missed = answered(State(line(slope=40.0)), 1, first)
    model = mf.Interacting(contact=mf.JKR(9e-6))
    given = replace(missed, specification=replace(missed.specification, model=model), advice="")
    found = _advised(given, missed.design)
    assert found.advice.endswith(", without interaction")


def test_a_draft_and_a_line_that_is_met_have_no_advice(first):
    assert not answered(State(line(friction_coefficient=20.0)), 1, first, draft=True).advice
    assert not answered(State(line(friction_coefficient=3.0)), 1, first).advice


@pytest.mark.parametrize("coefficient", [1.7, 20.0])
def test_an_impossible_coefficient_names_the_largest_over_these_loads(first, coefficient):
    found = answered(State(line(friction_coefficient=coefficient, load_range=LOADS)), 1, first)
    assert found.refusal
    assert 1.5 < found.nearest_target.wording.coefficient(found.nearest_target.slope) < 1.6
    words = offer(found).removeprefix("Use ")
    assert words.startswith("friction coefficient 1.5")
    assert f"The largest over these loads is {words}" in found.refusal
    used = answered(State(with_nearest(found)), 2, found)
    assert used.current
    np.testing.assert_allclose(coefficients(used), float(words.split()[-1]), rtol=0.01)
