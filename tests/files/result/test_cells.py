"""Periodic cells in specifications, results and tables of laws."""

import numpy as np
import pytest

import metafem as mf
from metafem.files import demo_text, parsed

TEXT = demo_text("operating-points")
LATTICE = mf.Surface.square_lattice(
    0.12, (2, 3), 1.5, radius=0.526, material=mf.Material(1.36), friction=mf.Friction(0.35),
    block=mf.Block(20.0, 20.0, 7.0), cell=mf.PeriodicCell(4.5, 3.0),
)  # fmt: skip


def test_a_design_keeps_its_cell(tmp_path):
    design = mf.design(mf.PowerLaw(0.9, (0.02, 0.05)), LATTICE, mf.Interacting(substrate=mf.BondedLayer()))
    mf.save(design, tmp_path / "result")
    again = mf.load(tmp_path / "result")
    assert again == design
    assert again.surface.cell == again.law.cell == LATTICE.cell
    header = (tmp_path / "result/law.csv").read_text("utf-8").partition("\n")[0]
    assert header.endswith("nominal_pressure_MPa,nominal_shear_stress_MPa")


def test_a_law_says_that_the_part_is_one_period():
    notes = [note.text for note in mf.friction_law(LATTICE, load=[0.02]).notes]
    assert any("the part has one period of 4.5 by 3 mm" in text for text in notes)


def test_loads_and_forces_per_area():
    law = mf.friction_law(LATTICE, mf.Interacting(), load=[0.02, 0.05])
    np.testing.assert_allclose(law.nominal_pressure, law.load / 13.5, rtol=1e-15)
    np.testing.assert_allclose(law.nominal_shear_stress, 0.35 * law.area / 13.5, rtol=1e-15)
    alone = mf.friction_law(LATTICE.replaced(cell=None), load=[0.02])
    with pytest.raises(mf.InvalidInput, match=r"cell=metafem\.PeriodicCell"):
        _ = alone.nominal_pressure


@pytest.mark.parametrize(
    ("section", "sides"),
    [("[cell]\n", (12.0, 12.0)), ('[cell]\nwidth = "16 mm"\n', (16.0, 12.0))],
)
def test_the_specification_states_the_cell(section, sides):
    assert parsed(TEXT + section).template.cell == mf.PeriodicCell(*sides)


def test_a_cell_smaller_than_the_lattice_is_named():
    with pytest.raises(mf.InvalidInput, match=r"cell\.width = 5 mm is smaller than the extent"):
        parsed(TEXT + '[cell]\nwidth = "5 mm"\n')


def test_caps_of_adjacent_periods_overlap():
    wide = LATTICE.replaced(cell=mf.PeriodicCell(3.4, 3.0), height=np.full(6, 0.12))
    (note,) = [note.text for note in mf.friction_law(wide, load=[0.02]).notes if "caps of" in note.text]
    assert note.startswith("the caps of 2 pairs")
    assert not any("caps of" in note.text for note in mf.friction_law(LATTICE, load=[0.02]).notes)
