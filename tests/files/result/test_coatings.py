"""Friction that differs from asperity to asperity, in specifications, tables, folders and reports."""

import json

import meshio
import numpy as np
import pytest

import metafem as mf
from metafem.explorer.law.reach import reach_of
from metafem.explorer.text.fields import shown, typed_value
from metafem.explorer.text.handles import scene_of
from metafem.files import all_keys, demo_text, parsed, read_surface
from metafem.files.result.records import from_record, to_record
from metafem.files.result.tables import heights_table
from metafem.surface import Surface

MATERIAL = mf.Material(1.36)
COATED = mf.Friction([0.4, 0.1, 0.1, 0.4], 0.85)
HEADER = "x_mm,y_mm,height_um,radius_um"


def text(friction='shear_strength = ["0.4 MPa", "0.1 MPa", "100 kPa", "0.4 MPa"]\narea_ratio = 0.85'):
    demo = demo_text("operating-points")
    at = demo.index("[friction]")
    demo = demo[:at] + f"[friction]\n{friction}\n\n" + demo[demo.index("\n[", at) + 1 :]
    demo = demo.replace("shape = [8, 8]", "shape = [2, 2]")
    start = demo.index("[target]")
    target = 'kind = "operating-points"\nload = ["0.05 N", "0.1 N"]\nfriction_force = ["0.05 N", "0.09 N"]\n'
    return demo[:start] + f"[target]\n{target}\n" + demo[demo.index("\n[", start) + 1 :]


def test_a_specification_is_designed_saved_and_reported(tmp_path):
    found = parsed(text())
    assert found.template.friction == COATED
    design = found.design()
    assert design.status.name == "EXACT"
    mf.save(design, tmp_path / "coated")
    again = mf.load(tmp_path / "coated")
    assert again.surface == design.surface
    assert again.law == design.law
    np.testing.assert_array_equal(again.law.friction_area, design.law.friction_area)
    surface = read_surface(tmp_path / "coated" / "heights.csv", MATERIAL)
    assert surface.friction == COATED
    law = mf.friction_law(surface, load=[0.05, 0.1])
    np.testing.assert_allclose(law.friction_force, [0.05, 0.09], rtol=1e-9)
    assert "0.1 – 0.4" in mf.report.page(design)
    points = meshio.read(tmp_path / "coated" / "surface.vtu").point_data
    np.testing.assert_array_equal(points["shear_strength_MPa"], [0.4, 0.1, 0.1, 0.4])
    table = np.genfromtxt(tmp_path / "coated" / "law.csv", delimiter=",", names=True)
    np.testing.assert_allclose(table["friction_force_N"], 0.34 * table["rescaled_friction_mm2"], rtol=1e-9)
    assert (table["area_mm2"] > table["rescaled_friction_mm2"]).all()


@pytest.mark.parametrize(
    ("friction", "words"),
    [
        ('shear_strength = ["0.4 MPa", "0.1 MPa"]', "friction.shear_strength has 2 values for 4 asperities"),
        ('shear_strength = ["0.4 MPa", "0.1 mm"]', r"friction.shear_strength\[1\] = .0.1 mm. has the unit"),
        (
            'shear_strength = "0.4 MPa"\narea_ratio = [1.0, -0.5, 1.0, 1.0]',
            r"friction.area_ratio\[1\] = -0.5",
        ),
        (
            'shear_strength = "0.4 MPa"\narea_ratio = [1.0, "a", 1.0, 1.0]',
            r"area_ratio\[1\].*must be a number",
        ),
        ("shear_strength = []", "friction.shear_strength"),
    ],
)
def test_wrong_lists_are_named(friction, words):
    with pytest.raises(mf.InvalidInput, match=words):
        parsed(text(friction))


def test_equal_values_of_a_list_are_one_value():
    found = parsed(text('shear_strength = ["0.4 MPa", "0.4 MPa", "400 kPa", "0.4 MPa"]'))
    assert found.template.friction == mf.Friction(0.4)


def test_the_columns_are_written_only_if_the_frictions_differ():
    make = {"radius": 0.526, "material": MATERIAL}
    one, differing = (
        Surface.square_lattice(0.1, (2, 2), friction=friction, **make)
        for friction in (mf.Friction(0.4, 0.85), COATED)
    )
    sites = np.arange(4)
    assert heights_table(one, sites).splitlines()[0] == "site,x_mm,y_mm,height_mm,radius_mm"
    title, first, *_ = heights_table(differing, sites).splitlines()
    assert title.endswith("radius_mm,shear_strength_MPa,area_ratio")
    assert first.endswith("0.526,0.4,0.85")


def test_a_table_states_the_frictions(tmp_path):
    path = tmp_path / "heights.csv"
    path.write_text(f"{HEADER},shear_strength_kPa\n0,0,100,526,400\n1.5,0,110,526,100\n")
    assert read_surface(path, MATERIAL).friction == mf.Friction([0.4, 0.1])
    with pytest.raises(mf.InvalidInput, match="has a column shear_strength, and --shear-strength is given"):
        read_surface(path, MATERIAL, friction=mf.Friction(0.4))
    path.write_text(f"{HEADER},area_ratio\n0,0,100,526,0.8\n")
    with pytest.raises(mf.InvalidInput, match="needs a column shear_strength_MPa"):
        read_surface(path, MATERIAL)
    path.write_text(f"{HEADER},shear_strength_MPa\n0,0,100,526,0.4\n1,0,100,526,-1\n")
    with pytest.raises(mf.InvalidInput, match="line 3: shear_strength_MPa = -1"):
        read_surface(path, MATERIAL)


def test_a_record_of_an_earlier_version_has_no_friction_area():
    surface = Surface.square_lattice(0.1, (2, 2), radius=0.526, material=MATERIAL, friction=mf.Friction(0.4))
    record = to_record(mf.friction_law(surface, load=[0.1]))
    del record["friction_area"]
    assert from_record(record).friction_area is None
    coated = mf.friction_law(surface.replaced(friction=COATED), load=[0.1])
    again = from_record(json.loads(json.dumps(to_record(coated))))
    assert again == coated
    record = to_record(coated)
    del record["friction_area"]
    with pytest.raises(mf.InvalidInput, match="friction_area must be given if the asperities differ"):
        from_record(record)


def test_the_explorer_reads_and_shows_a_list():
    form = next(key for key in all_keys() if (key.section, key.name) == ("friction", "shear_strength"))
    typed = ["0.4 MPa", "0.1 MPa", "100 kPa", "0.4 MPa"]
    assert typed_value(form, shown(typed)) == typed
    assert typed_value(form, "[0.4 MPa, 0.1 MPa]") == typed[:2]
    assert typed_value(form, "0.4 MPa") == "0.4 MPa"
    ratio = next(key for key in all_keys() if key.name == "area_ratio")
    assert typed_value(ratio, "0.85, 1.0") == [0.85, 1.0]
    found = parsed(text())
    assert len(scene_of(text(), found, found.design()).handles()) == 2
    assert reach_of(found) is None  # the bounds are those of one friction
