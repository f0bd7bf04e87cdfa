"""The tables and answers of studies."""

import numpy as np

import metafem as mf
from metafem.studies import summary
from metafem.studies.summaries.tolerances import shown
from tests.conftest import MATERIAL, RADIUS


def test_a_table_has_at_most_twelve_rows_and_whole_numbers(rough):
    for count, step in ((1, 1), (12, 1), (13, 2), (31, 5), (1000, 100)):
        rows = shown(count)
        assert (rows[-1], len(rows) <= 12, set(np.diff(rows)) <= {step}) == (count - 1, True, True)
    study = mf.studies.manufacturing(rough, 0.001, draws=20)
    study = study.assign(saving=40_500.0 + 0.0 * study["saving"])
    table = summary(study)
    assert table.rows[0][table.columns.index("plain draws of equal error")] == "810,000"


def test_no_limit_is_stated_where_there_is_none(linear):
    one = mf.Surface([[0.0, 0.0]], [0.1], RADIUS, MATERIAL)
    few = linear.replaced(position=linear.position[:4], height=linear.height[::16], radius=RADIUS)
    made = mf.studies.manufacturing
    for study, largest, answer in (
        (made(one, 0.001, draws=64, load_range=(0.01, 0.02)), np.inf, "No errors were found"),
        (made(few, 0.001, draws=64, others=mf.Tolerances(radius_sd=0.05)), np.nan, "No errors are small"),
        (made(linear, 0.001, draws=8), None, "The draws are too few"),
    ):
        assert summary(study).answer.startswith(answer)
        assert largest is None or np.array_equal(study.largest_height_sd, largest, equal_nan=True)
    tilts = mf.studies.misalignment(one, 0.01, load_range=(0.01, 0.02))
    assert summary(tilts).answer.startswith("No errors were found")


def test_a_misfit_of_rounding_is_none(template):
    design = mf.design(mf.OperatingPoints([0.0747], [0.642]), template)
    found = summary(mf.studies.combined(design, mf.Tolerances(height_sd=0.003), draws=64))
    assert found.notes[0].text.startswith("misfit 0 % without errors; median of the surfaces")


def test_the_inputs_with_the_largest_share_are_named(template):
    inputs = {"composite_modulus": 0.04, "radius": 0.002}
    found = summary(mf.studies.uncertainty(template, inputs, draws=500, load=[0.3]))
    assert found.answer.startswith("The composite modulus E* matters most: its error accounts for 9")
    assert [row[0] for row in found.rows] == ["composite modulus E*", "radius R"]


def test_numbers_and_notes_of_a_summary(template):
    design = mf.design(mf.LinearLaw(6.87), template.replaced(block=None))
    found = mf.studies.fidelity(design)
    table = summary(found)
    assert [row[0] for row in table.rows] == ["independent", "half-space"]
    assert table.rows[0][1] == "0.00"
    last = found.isel(rescaled_load=-1)
    for k, row in enumerate(table.rows):
        change = 100.0 * found.area_change.values[k]
        shown = [np.sqrt((change**2).mean()), np.abs(change).max(), change[-1]]
        cells = [float(row[1]), abs(float(row[2])), float(row[5])]
        np.testing.assert_allclose(cells, shown, atol=0.0051)
        numbers = [float(last.area[k]), 1000.0 * float(last.separation[k]), 1000.0 * float(last.sinking[k])]
        np.testing.assert_allclose([float(cell) for cell in row[6:]], numbers, rtol=1e-4, atol=0.0051)
    assert {len(row) for row in table.rows} == {len(table.columns)}
    assert len(table.notes) == 2
