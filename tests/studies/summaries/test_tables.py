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
