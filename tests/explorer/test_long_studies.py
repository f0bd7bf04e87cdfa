"""The long studies of the panel, against the studies of the package."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import metafem as mf
from metafem.explorer.certainty import long_studies
from metafem.explorer.certainty.long_studies import STUDIES, Found, LongStudy, run
from metafem.notes import Note
from metafem.prediction import Tolerances

TOLERANCES = Tolerances(height_sd=0.001)


@pytest.fixture(scope="module")
def design():
    block = mf.Block(10.0, 10.0, 7.2)
    template = mf.Surface.square_lattice(0.2, (3, 3), radius=0.526, material=mf.Material(1.36), block=block)
    return mf.design(mf.OperatingPoints([0.05, 0.1], [0.25, 0.45]), template)


def test_draws_are_those_of_the_study(design, monkeypatch):
    monkeypatch.setattr(long_studies, "DRAWS", 64)
    found = run("draws", design, TOLERANCES)
    study = mf.studies.manufacturing(design.surface, [0.0005, 0.001, 0.002], draws=64, model=design.law.model)
    expected = mf.studies.summary(study)
    assert (found.answer, found.rows, found.notes) == (expected.answer, expected.rows, expected.notes)
    assert found.picture.startswith("<svg ")


def test_tilts_are_those_of_the_study(design):
    found = run("misalignment", design, None)
    study = mf.studies.misalignment(design.surface, np.radians(0.1), model=design.law.model, shuffles=20)
    assert (found.answer, found.rows) == (mf.studies.summary(study).answer, mf.studies.summary(study).rows)


def test_resolved_contacts_are_those_of_the_model(design):
    found = run("resolved", design, None)
    load = design.law.load[-1]
    area = mf.friction_law(design.surface, mf.BoundaryElements(cell=0.008), load=[load]).area[0]
    assert found.rows[-1][:3] == (
        f"{load:.3g}",
        f"{design.law.model.curve(design.surface, design.law.rescaled_load[-1:]).area[0]:.4g}",
        f"{area:.4g}",
    )
    assert {len(row) for row in found.rows} == {len(found.columns)}


def test_a_long_study_is_that_of_the_package(design, monkeypatch):
    # the influence of a block takes half a minute; the layer in its place takes none
    monkeypatch.setattr("metafem.studies.substrates._true_block", lambda *given: (mf.BondedLayer(), ""))
    found = run("block", design, None)
    study = mf.studies.fidelity(design, elements=False)
    change = study.area_change.sel(model="block").values
    assert found.rows == mf.studies.summary(study).rows
    assert f"{100 * np.sqrt((change**2).mean()):.2g} %" in found.answer
    assert found.picture.startswith("<svg ")
    law = mf.friction_law(design.surface, mf.Independent(mf.KogutEtsion(10.0)), load=design.law.load)
    assert STUDIES["resolved"].hindered(replace(design, law=law)) != ""
    assert STUDIES["resolved"].hindered(design) == ""

    def warning(design, tolerances):
        for _ in range(2):
            warnings.warn("the block is coarse", mf.MetafemWarning, stacklevel=1)
        return Found("title", (), (), (), "Done.")

    monkeypatch.setitem(STUDIES, "block", LongStudy("Block", "?", "a second", warning))
    assert run("block", design, None).notes == (Note("the block is coarse"),)
