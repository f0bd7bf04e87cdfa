"""The data of the plot of the law: curves, bands, pinned and measured points."""

from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.answer import answered
from metafem.explorer.certainty import tolerance_band
from metafem.explorer.history import State
from metafem.explorer.law import beside
from metafem.explorer.law_data import (
    NO_FORCES,
    Units,
    law_data,
    measured_data,
    numbers,
    pinned_data,
    read_points,
)
from metafem.files import demo_text

TEXT = demo_text("operating-points")
PAIR = mf.Material(1.36), mf.Friction(0.37, 0.85)
STRESS = 0.37 * 0.85
FORCES = "load_mN,friction_force_mN\n200,260\n100,120\n400,530\n"


@pytest.fixture(scope="module")
def answer():
    return answered(State(TEXT, newtons=False), 7)


def test_curves_are_the_laws_in_rescaled_units_and_in_newtons(answer):
    law, data = answer.design.law, law_data(answer)
    assert (data["number"], data["marked"], data["model"], data["crowd"]) == (7, True, "independent", "")
    assert (data["x"]["unit"], data["y"]["label"]) == ("mm²", "friction F/(σB)")
    np.testing.assert_allclose(data["achieved"]["x"], law.rescaled_load, rtol=1e-4)
    np.testing.assert_allclose(data["achieved"]["y"], law.area, rtol=1e-4)
    np.testing.assert_allclose(data["wanted"]["y"], [0.84, 1.68, 4.12])
    forces = law_data(answered(State(TEXT, load=0.2), 8, answer))
    np.testing.assert_allclose(forces["achieved"]["x"], law.load, rtol=1e-4)
    np.testing.assert_allclose(forces["achieved"]["y"], law.friction_force, rtol=1e-4)
    assert (forces["y"]["unit"], forces["load_scale"]) == ("N", 1.36)
    assert forces["cursor"] == pytest.approx(0.2 * 1.36)
    handle = forces["handles"][1]
    assert (handle["id"], handle["x"], handle["y"]) == (
        "point-1", pytest.approx(0.336 * 1.36), pytest.approx(1.68 * STRESS),
    )  # fmt: skip


def test_the_last_law_keeps_the_newtons_of_its_own_material(answer):
    stiff = TEXT.replace('"1.36 MPa"', '"2 MPa"').replace('"1.68 mm^2"', '"3.9 mm^2"')
    data = law_data(answered(State(stiff, load=0.2), 8, answer))
    np.testing.assert_allclose(data["achieved"]["x"], answer.design.law.load, rtol=1e-4)
    assert data["wanted"]["x"] == pytest.approx([2.0 * load for load in (0.144, 0.336, 0.649)])
    assert data["cursor"] == pytest.approx(0.2 * 1.36)
    broken = law_data(answered(State(TEXT.replace('"270 um"', "270")), 9, answer))
    assert (broken["x"]["unit"], broken["handles"]) == ("N", None)
    units = Units.of(answer.template, True)
    assert units.rescaled(units.load * 0.3, units.friction * 1.7) == pytest.approx((0.3, 1.7))
    without = replace(answer.template, friction=None)
    assert Units.of(without, True) == Units()


def test_curves_are_thinned():
    x = np.linspace(0.0, 1.0, 5001)
    curve = Units().curve(x, x**2)
    assert (len(curve["x"]), curve["x"][-1]) == (200, 1.0)
    assert numbers([1.23456789, np.nan, np.inf]) == [1.2346, None, None]


def test_the_plot_gets_its_choices_and_the_newest_band(answer):
    assert law_data(answer)["tools"] == {"newtons": False, "no_forces": ""}
    assert law_data(replace(answer, design=None))["tools"]["no_forces"] == NO_FORCES
    found, law = beside(answer), answer.design.law
    tolerance = found["tolerance"]
    assert found["number"] == 7
    for name, band in zip(("x", "low", "high"), tolerance_band(answer), strict=True):
        np.testing.assert_allclose(tolerance[name], band, rtol=1e-4)
    assert "SD" in tolerance["name"]
    np.testing.assert_allclose(pinned_data(answer, Units())["y"], law.area, rtol=1e-4)
    assert pinned_data(None, Units()) is None


def test_measured_points_are_rescaled(answer):
    texts = FORCES, FORCES.replace("load_mN,friction_force_mN", "Load [mN],Friction force [mN]")
    for text in (*texts, FORCES.replace("load_mN,friction_force_mN", "P [mN],F [mN]").replace(",", ";")):
        load, friction = read_points("m.csv", text, *PAIR)
        np.testing.assert_allclose(load, np.array([0.1, 0.2, 0.4]) / 1.36)
        np.testing.assert_allclose(friction, np.array([0.12, 0.26, 0.53]) / STRESS)
    rows = "rescaled_load_mm2,rescaled_friction_mm2\n0.1,0.2\n50,60\n"
    assert read_points("m.csv", rows, PAIR[0], None)[0].tolist() == [0.1, 50.0]
    data = measured_data(answered(State(TEXT, measured=FORCES, measured_name="m.csv"), 2, answer))
    assert (data["name"], data["x"]) == ("m.csv: 3 points", [0.1, 0.2, 0.4])
    assert measured_data(answer) is None
