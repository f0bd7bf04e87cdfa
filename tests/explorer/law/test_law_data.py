"""The data of the plot are the numbers of the answer."""

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import answered
from metafem.explorer.law.law_data import band_data, law_data
from metafem.explorer.law.reach import reach_of
from metafem.explorer.law.shown import Units, numbers
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.files import demo_text

TEXT = demo_text("operating-points")


@pytest.fixture(scope="module")
def answer():
    return answered(State(TEXT, newtons=False), 7)


def test_curves_are_the_laws_in_rescaled_units_and_in_newtons(answer):
    law = answer.design.law
    data = law_data(answer)
    assert data["number"] == 7
    assert data["marked"]
    assert data["model"] == "independent"
    np.testing.assert_allclose(data["achieved"]["x"], law.rescaled_load, rtol=1e-4)
    np.testing.assert_allclose(data["wanted"]["y"], [0.84, 1.68, 4.12])
    forces = law_data(answered(State(TEXT, load=0.2), 8, answer))
    np.testing.assert_allclose(forces["achieved"]["x"], law.load, rtol=1e-4)
    np.testing.assert_allclose(forces["achieved"]["y"], law.friction_force, rtol=1e-4)
    assert forces["y"]["unit"] == "N"
    assert forces["cursor"] == pytest.approx(0.2 * 1.36)


def test_the_last_law_keeps_the_newtons_of_its_own_material(answer):
    """The load at which the map shows its contacts is that of the marker, also under another material."""
    law = answer.design.law
    stiff = TEXT.replace('"1.36 MPa"', '"2 MPa"').replace('"1.68 mm^2"', '"3.9 mm^2"')
    refused = answered(State(stiff, newtons=True, load=0.2), 8, answer)
    assert refused.refusal
    assert refused.design is answer.design
    data = law_data(refused)
    np.testing.assert_allclose(data["achieved"]["x"], law.load, rtol=1e-4)
    np.testing.assert_allclose(data["achieved"]["y"], law.friction_force, rtol=1e-4)
    assert data["wanted"]["x"] == pytest.approx([2.0 * load for load in (0.144, 0.336, 0.649)])
    assert data["cursor"] == pytest.approx(0.2 * 1.36)
    without = TEXT.replace('"1.68 mm^2"', '"3.9 mm^2"').replace("[friction]", "[robust]")
    without = without.replace('shear_strength = "0.370 MPa"', 'height_sd = "1 um"').replace("area_ratio", "#")
    rescaled = law_data(answered(State(without, newtons=True), 9, answer))
    np.testing.assert_allclose(rescaled["achieved"]["x"], law.rescaled_load, rtol=1e-4)


def test_units_return_to_the_rescaled_values(answer):
    units = Units.of(answer.template, True)
    x, y = units.rescaled(units.load * 0.3, units.friction * 1.7)
    assert (x, y) == pytest.approx((0.3, 1.7))
    without = (
        TEXT.replace('shear_strength = "0.370 MPa"', "")
        .replace("area_ratio = 0.85", "")
        .replace("[friction]", "")
    )
    assert Units.of(answered(State(without), 1).template, True) == Units()


def test_a_text_with_problems_keeps_the_units_of_the_last_design(answer):
    broken = answered(State(TEXT.replace('"270 um"', "270"), newtons=True), 9, answer)
    data = law_data(broken)
    assert data["x"]["unit"] == "N"
    assert data["handles"] is None
    assert "needs a unit" in data["refusal"]


def test_the_reach_contains_the_law_and_is_computed_once(answer):
    band = reach_of(answer.specification)
    load, low, high = band
    law = answer.design.law
    inside = np.interp(law.rescaled_load, load, high) >= law.area
    assert inside.all()
    assert (np.interp(law.rescaled_load, load, low) <= 1.001 * law.area).all()
    moved = answered(State(TEXT.replace('"0.84 mm^2"', '"0.85 mm^2"')), 1)
    assert reach_of(moved.specification) is band
    higher = answered(State(TEXT.replace('"270 um"', '"280 um"')), 1)
    assert reach_of(higher.specification) is not band
    shown = band_data(band, Units())
    assert len(shown["x"]) == len(shown["low"]) == len(shown["high"]) <= 200


def test_the_reach_of_n_equal_asperities_is_that_of_hertz(answer):
    load, low, high = reach_of(answer.specification)
    radius = 0.526
    single = np.pi * radius * (0.75 * load / np.sqrt(radius)) ** (2 / 3)
    np.testing.assert_allclose(low, single, rtol=1e-9)
    np.testing.assert_allclose(high, 64 ** (1 / 3) * single, rtol=1e-9)
    # it ends where 64 summits of the largest height are pressed to the base plane
    assert load[-1] == pytest.approx(64 * 4 / 3 * np.sqrt(radius) * 0.27**1.5)


def test_empty_sites_narrow_the_reach():
    text = TEXT + "\n[sites]\nempty = [0, 1, 2, 3]\n"
    _load, low, high = reach_of(answered(State(text), 1).specification)
    np.testing.assert_allclose(high / low, 60 ** (1 / 3), rtol=1e-9)


def test_adhesion_has_no_proven_reach():
    text = TEXT + '\n[contact]\nkind = "jkr"\nadhesion_energy = "9 mJ/m^2"\n'
    assert reach_of(answered(State(text), 1).specification) is None


def test_the_reach_is_told_as_that_of_independent_asperities_where_they_interact(answer):
    text = TEXT.replace('kind = "independent"', 'kind = "half-space"')
    assert law_data(answer)["reach"] == "possible at one load"
    assert "independent asperities" in law_data(answered(State(text), 1))["reach"]


def test_curves_have_a_bounded_number_of_points_and_no_nan():
    x = np.linspace(0.0, 1.0, 5001)
    curve = Units().curve(x, x**2)
    assert len(curve["x"]) == 200
    assert curve["x"][-1] == 1.0
    assert numbers([1.23456789, np.nan, np.inf]) == [1.2346, None, None]


@pytest.mark.parametrize("name", ["linear", "bilinear"])
def test_slopes_are_drawn_along_their_branches(name):
    answer = answered(State(demo_text(name), newtons=False), 1)
    wanted = law_data(answer)["wanted"]
    slopes = [branch.slope for branch, _ in answer.design.fits]
    ends = [i for i, x in enumerate(wanted["x"]) if x is None]
    starts = [0, *(i + 1 for i in ends)]
    for start, slope in zip(starts, slopes, strict=True):
        rise = wanted["y"][start + 1] - wanted["y"][start]
        assert rise / (wanted["x"][start + 1] - wanted["x"][start]) == pytest.approx(slope, rel=1e-3)


def test_an_open_power_law_is_drawn_at_its_nearest_level():
    text = TEXT[: TEXT.index("[target]")] + "\n".join(
        ["[target]", 'kind = "power"', "exponent = 1.1", 'load_range = ["0.1 mm^2", "0.4 mm^2"]', ""]
    )
    answer = answered(State(text + TEXT[TEXT.index("[material]") :], newtons=False), 1)
    wanted = law_data(answer)["wanted"]
    exponent = np.polyfit(np.log(wanted["x"]), np.log(wanted["y"]), 1)[0]
    assert exponent == pytest.approx(1.1, rel=1e-4)
    achieved = np.interp(wanted["x"], answer.design.law.rescaled_load, answer.design.law.area)
    np.testing.assert_allclose(wanted["y"], achieved, rtol=0.03)
    assert mf.PowerLaw is type(answer.specification.target)


def test_points_that_are_too_many_to_drag_are_a_line_that_says_so():
    load = np.linspace(0.01, 0.6, 500)
    text = Document(TEXT).with_values(
        {
            "target.rescaled_load": [f"{value:.6g} mm^2" for value in load],
            "target.rescaled_friction": [f"{7.0 * value:.6g} mm^2" for value in load],
        }
    )
    crowded = answered(State(text), 1)
    data = law_data(crowded)
    assert data["crowd"] == "500 points, too many to drag"
    assert not data["marked"]
    assert data["handles"] == []
    assert len(data["wanted"]["x"]) == 200
