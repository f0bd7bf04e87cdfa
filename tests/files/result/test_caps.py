"""Caps that differ, in tables, drawings, pictures and records."""

import numpy as np
import pytest

import metafem as mf
from metafem.files.part.mould_drawing import mould_drawing
from metafem.files.part.plan import PartOptions, planned
from metafem.files.result.records import from_record, to_record
from metafem.files.result.tables import heights_table, mould_table, read_surface

CAPS = [mf.Power(4, 0.3), mf.Sphere(), mf.Paraboloid(), mf.Power(4, 0.3)]
PART = mf.Surface.square_lattice(
    [0.1, 0.11, 0.12, 0.13], (2, 2), radius=[0.5, 0.5, 0.6, 0.7], material=mf.Material(1.36), cap=CAPS,
    block=mf.Block(8, 8, 4),
)  # fmt: skip


def test_a_table_of_summits_carries_the_caps(tmp_path):
    path = tmp_path / "heights.csv"
    path.write_text(heights_table(PART, np.arange(4)), "utf-8")
    assert read_surface(path, PART.material, block=PART.block) == PART
    path.write_text(heights_table(PART.replaced(cap=mf.Sphere()), np.arange(4)), "utf-8")
    assert "cap" not in path.read_text("utf-8")


@pytest.mark.parametrize("text", ["cone", "power", "power 1", "power x", "sphere 2", ""])
def test_an_unknown_cap_is_named(tmp_path, text):
    path = tmp_path / "heights.csv"
    path.write_text(f"x_mm,y_mm,height_um,radius_um,cap\n0,0,100,500,{text}\n", "utf-8")
    with pytest.raises(mf.InvalidInput, match="exponent" if text == "power 1" else f"cap = '{text}' must be"):
        read_surface(path, PART.material)


def test_a_record_keeps_the_caps():
    assert from_record(to_record(PART)) == PART
    old = {name: value for name, value in to_record(PART).items() if name != "cap"}
    assert from_record(old) == PART.replaced(cap=mf.Sphere())


def test_a_mould_has_a_tool_for_each_radius_and_cap():
    text = mould_drawing(PART, 4, PART.block)
    for words in (
        "1 holes, tool radius R 0.5, power 4.0 0.3", "1 holes, tool radius R 0.5, sphere",
        "1 holes, tool radius R 0.6, paraboloid", "1 holes, tool radius R 0.7, power 4.0 0.3",
    ):  # fmt: skip
        assert words in text
    part = planned(PART, PART, PartOptions(alignment_height=0.2))
    assert part.surface.count == 8
    assert [part.surface.cap.one(i) for i in range(4)] == CAPS


def test_a_saved_design_keeps_its_caps(tmp_path):
    template = PART.replaced(cap=mf.Power(4, 0.3), radius=0.5 * np.ones(4))
    design = mf.design(mf.OperatingPoints([0.01], [0.2]), template, mf.Independent(mf.Elastic()))
    assert design.misfit < 1e-9
    mf.save(design, tmp_path / "result")
    assert mf.load(tmp_path / "result") == design
    assert "power 4.0 0.3" in (tmp_path / "result" / "mould.csv").read_text("utf-8")
    assert mould_table(design).splitlines()[0].endswith("tool_radius_mm,cap")
