"""Targets of another kind near the present law."""

import tomllib

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.text.document import Document
from metafem.explorer.text.kinds import ATTEMPTS, with_target_kind
from metafem.files import demo_text, parsed, section_forms
from metafem.files.specification.demos import DEMOS


@pytest.fixture(
    scope="module",
    params=[name if name == "linear" else pytest.param(name, marks=pytest.mark.slow) for name in DEMOS],
)
def demo(request):
    text = demo_text(request.param)
    specification = parsed(text)
    return text, specification, specification.design()


def law_of(design, load):
    return np.interp(load, design.law.rescaled_load, design.law.rescaled_friction)


def test_all_kinds_are_known():
    assert set(ATTEMPTS) == set(section_forms()[0].kinds)


@pytest.mark.parametrize("kind", ATTEMPTS)
def test_each_demo_can_be_designed_as_each_kind_near_its_law(demo, kind):
    text, specification, design = demo
    new = with_target_kind(text, specification, design, kind)
    found = parsed(new).design()
    assert tomllib.loads(new)["target"]["kind"] == kind
    assert found.status is not type(found.status).MISSED
    high = min(found.law.rescaled_load[-1], design.law.rescaled_load[-1])
    load = np.linspace(0.3 * high, high, 20)
    difference = law_of(found, load) / law_of(design, load) - 1.0
    assert np.sqrt((difference**2).mean()) < 0.2


def test_the_units_stay():
    text = Document(demo_text("linear")).with_kind("target", "linear", {"friction_coefficient": 1.55})
    specification = parsed(text)
    design = specification.design()
    keys = {kind: tomllib.loads(with_target_kind(text, specification, design, kind))["target"]
            for kind in ATTEMPTS}  # fmt: skip
    assert keys["operating-points"].keys() == {"kind", "load", "friction_force"}
    assert all(load.endswith(" N") for load in keys["sampled"]["load"] + keys["power"]["load_range"])
    assert keys["bilinear"].keys() == {"kind", "friction_coefficients", "crossover_load"}
    assert keys["linear"] == {"kind": "linear", "friction_coefficient": 1.55}


@pytest.mark.parametrize("kind", ["operating-points", "bilinear", "multilinear"])
def test_newtons_can_be_chosen(kind):
    text = demo_text("linear")
    specification = parsed(text)
    design = specification.design()
    rescaled, newtons = (
        Document(with_target_kind(text, specification, design, kind, forces)).value("target")
        for forces in (False, True)
    )
    assert ("mm^2" in str(rescaled), "mm^2" in str(newtons)) == (True, False)
    assert newtons.keys() & {"load", "friction_coefficients"}


def test_without_a_design_the_values_are_examples():
    text = demo_text("linear")
    new = with_target_kind(text, parsed(text), None, "power")
    assert new == Document(text).with_kind("target", "power")
    with pytest.raises(mf.InvalidInput, match="unknown"):
        with_target_kind(text, parsed(text), None, "cubic")


def test_the_table_of_a_contact_is_kept():
    table = b"indentation_um,load_mN,area_mm2\n5,0.46,0.0083\n20,3.7,0.033\n90,35,0.15\n"
    text = demo_text("bilinear") + '[contact]\nkind = "tabulated"\nfile = "lab/contact.csv"\n'
    specification = parsed(text, {"lab/contact.csv": table})
    design = parsed(demo_text("bilinear")).design()
    new = with_target_kind(text, specification, design, "sampled")
    assert parsed(new, {"lab/contact.csv": table}).target.rescaled_load.size == 8
