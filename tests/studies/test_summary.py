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
    told = summary(found)
    assert [row[0] for row in told.rows] == ["independent", "half-space"]
    assert told.rows[0][1] == "0.00"
    assert {len(row) for row in told.rows} == {len(told.columns)}
    assert len(told.notes) == 2
