"""The tables, answers and units of studies."""

import numpy as np

import metafem as mf
from metafem.prediction.base_law import described
from metafem.studies import summary
from metafem.studies.summary import shown


def test_a_table_has_at_most_ten_rows_that_end_with_the_last():
    assert [shown(count)[:: len(shown(count)) - 1 or 1] for count in (1, 10, 31, 1000)] == [
        [0], [0, 9], [2, 30], [99, 999],
    ]  # fmt: skip


def test_the_allowed_errors_are_between_those_studied(linear):
    made = mf.studies.manufacturing(linear, [0.0, 0.01, 0.06], draws=400)
    scatter = made.slope_sd.values / float(made.nominal_slope)
    limit = 1e3 * np.interp(0.01, scatter, [0.0, 0.01, 0.06])
    heights, words = "errors of the heights of up to", "the slope scatters by"
    for levels, answer in (
        ([0, 1, 2], f"With {heights} {limit:.3g} µm (SD) {words} less than 1 % (SD)"),
        ([0, 1], f"With {heights} 10 µm (SD) {words} less than 1 % (SD)"),
        ([2], f"Even with {heights} 60 µm (SD) {words} more than 1 % (SD)"),
    ):
        assert summary(made.isel(height_sd=levels)).answer.startswith(answer)
    tilted = mf.studies.misalignment(linear, np.radians(0.1), assignments=0)
    scatter = tilted.slope_sd.values[0] / float(tilted.nominal_slope)
    limit = np.degrees(np.interp(0.01, scatter, tilted.angle.values))
    assert summary(tilted).answer.startswith(f"With tilts within ±{limit:.3g}° the slope scatters by less")


def test_the_inputs_with_the_largest_share_are_named(template):
    inputs = {"composite_modulus": 0.04, "radius": 0.002}
    found = summary(mf.studies.uncertainty(template, inputs, load=[0.3]))
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
    assert len(table.notes) == 1


def test_every_variable_is_described(surface):
    sd = {"radius": 0.005, "shear_strength": 0.006}
    for study in (
        mf.studies.manufacturing(surface, [0.001], draws=16),
        mf.studies.misalignment(surface, [0.0005, 0.001], assignments=2),
        mf.studies.uncertainty(surface, sd, draws=16, load=[0.1]),
    ):
        for name, variable in study.variables.items():
            if variable.dtype.kind == "f":
                assert variable.attrs["units"] in {"1", "mm", "mm2", "rad", "N"}, name
                assert variable.attrs["long_name"], name
    units = {"friction_force_sd": "N", "friction_force_total_error": "1", "nominal_area": "mm2"}
    assert {name: described(name)["units"] for name in units} == units
    assert described("anything_else") == {}
