"""The tables of studies."""

import pytest
import xarray as xr

import metafem as mf
from metafem.studies import summary


def test_a_foreign_dataset_has_no_summary():
    with pytest.raises(mf.InvalidInput, match="no summary"):
        summary(xr.Dataset())


def test_numbers_and_notes_of_a_summary(template):
    design = mf.design(mf.LinearLaw(6.87), template.replaced(block=None))
    found = mf.studies.fidelity(design)
    table = summary(found)
    assert [row[0] for row in table.rows] == ["independent", "half-space"]
    assert table.rows[0][1] == "0.00"
    assert {len(row) for row in table.rows} == {len(table.columns)}
    assert len(table.notes) == 2


def test_the_number_of_equal_plain_draws_is_written_out(rough):
    study = mf.studies.manufacturing(rough, 0.001, draws=20)
    study = study.assign(saving=40_500.0 + 0.0 * study["saving"])
    table = summary(study)
    assert table.rows[0][table.columns.index("plain draws of equal error")] == "810,000"
