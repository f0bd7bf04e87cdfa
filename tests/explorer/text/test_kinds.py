"""Targets of another kind near the present law."""

import tomllib

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.session import State
from metafem.explorer.text.document import Document
from metafem.explorer.text.kinds import KINDS, with_kind
from metafem.explorer.workshop.form import form
from metafem.files import demo_text, parsed, section_forms
from metafem.files.specification.models import DEMOS


@pytest.fixture(
    scope="module",
    params=[name if name == "linear" else pytest.param(name, marks=pytest.mark.slow) for name in DEMOS],
)
def demo(request):
    text = demo_text(request.param)
    return text, parsed(text).design()


def law_of(design, load):
    return np.interp(load, design.law.rescaled_load, design.law.rescaled_friction)


def test_all_kinds_are_known():
    assert set(KINDS) == set(section_forms()[0].kinds)


def test_the_kinds_have_names_in_the_order_of_the_manual():
    (section,) = [part for part in form() if part["name"] == "target"]
    assert [[kind, section["kind_names"][kind]] for kind in section["kinds"]] == [
        [kind, KINDS[kind][0]] for kind in section_forms()[0].kinds
    ]


@pytest.mark.parametrize("kind", KINDS)
def test_each_demo_can_be_designed_as_each_kind_near_its_law(demo, kind):
    text, design = demo
    new = with_kind(State(text), design, kind)
    found = parsed(new).design()
    assert tomllib.loads(new)["target"]["kind"] == kind
    assert found.status is not type(found.status).MISSED
    high = min(found.law.rescaled_load[-1], design.law.rescaled_load[-1])
    load = np.linspace(0.3 * high, high, 20)
    difference = law_of(found, load) / law_of(design, load) - 1.0
    assert np.sqrt((difference**2).mean()) < 0.2


def test_the_units_stay():
    text = Document(demo_text("linear")).with_kind("target", "linear", {"friction_coefficient": 1.55})
    design = parsed(text).design()
    keys = {kind: tomllib.loads(with_kind(State(text), design, kind))["target"] for kind in KINDS}
    assert keys["operating-points"].keys() == {"kind", "load", "friction_force"}
    assert all(load.endswith(" N") for load in keys["sampled"]["load"] + keys["power"]["load_range"])
    assert keys["bilinear"].keys() == {"kind", "friction_coefficients", "crossover_load"}
    assert keys["linear"] == {"kind": "linear", "friction_coefficient": 1.55}


@pytest.mark.parametrize("newtons", [False, True])
def test_axes_change_nothing(newtons):
    text = demo_text("linear")
    design = parsed(text).design()
    new = with_kind(State(text, newtons=newtons), design, "operating-points")
    assert Document(new).value("target").keys() == {"kind", "rescaled_load", "rescaled_friction"}


def test_without_a_design_the_values_are_examples():
    text = demo_text("linear")
    assert with_kind(State(text), None, "power") == Document(text).with_kind("target", "power")
    assert with_kind(State(text), None, "linear") == text


def test_a_text_with_problems_has_the_values_of_examples():
    text = demo_text("linear").replace('"120 um"', '"120"')
    new = with_kind(State(text), parsed(demo_text("linear")).design(), "power")
    assert new == Document(text).with_kind("target", "power")


def test_unknown_kinds_and_texts_that_cannot_be_read_are_refused():
    with pytest.raises(mf.InvalidInput, match='kind = "cubic" is unknown'):
        with_kind(State(demo_text("linear")), None, "cubic")
    with pytest.raises(mf.InvalidInput, match="line 1"):
        with_kind(State("[target"), None, "linear")


def test_the_table_of_a_contact_is_kept():
    table = "indentation_um,load_mN,area_mm2\n5,0.46,0.0083\n20,3.7,0.033\n90,35,0.15\n"
    text = demo_text("bilinear") + '[contact]\nkind = "tabulated"\nfile = "lab/contact.csv"\n'
    design = parsed(demo_text("bilinear")).design()
    new = with_kind(State(text, {"lab/contact.csv": table}), design, "sampled")
    assert parsed(new, {"lab/contact.csv": table.encode()}).target.rescaled_load.size == 8


def test_points_of_two_branches_keep_the_crossover():
    text = Document(demo_text("bilinear")).with_values(
        {
            "target.slopes": [6.0, 9.0],
            "target.friction_coefficients": None,
            "target.crossover_load": "0.08 mm^2",
            "target.load_range": ["0.04 mm^2", "0.2 mm^2"],
        }
    )
    specification = parsed(text)
    assert specification.target.lines[1][1] == pytest.approx(0.08)
    found = parsed(with_kind(State(text), specification.design(), "operating-points")).target
    row = int(np.abs(found.rescaled_load - 0.08).argmin())
    assert found.rescaled_load[row] == pytest.approx(0.08)
    assert found.rescaled_friction[row] == pytest.approx(0.48, rel=0.03)
    left, right = (
        np.diff(found.rescaled_friction)[row - 1 : row + 1] / np.diff(found.rescaled_load)[row - 1 : row + 1]
    )
    assert right / left == pytest.approx(1.5, rel=0.1)
