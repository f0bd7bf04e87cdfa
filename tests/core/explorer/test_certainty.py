"""How sure a design is: its numbers, the band of made surfaces, and warnings at their places."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

import metafem as mf
from metafem.cli import main
from metafem.explorer import certainty
from metafem.explorer.answer import Answer, answered
from metafem.explorer.certainty import (
    NO_DESIGN,
    NOT_CURRENT,
    STUDIES,
    remarks,
    tables_of,
    warnings_by_place,
)
from metafem.explorer.history import State
from metafem.files import demo_text
from metafem.notes import Note, information
from metafem.prediction import tolerances
from tests.explorer.scenes import with_height

LINEAR, TEXT = demo_text("linear"), demo_text("operating-points")
EXACT = LINEAR.replace('height_sd = "0.9 um"', "")


@pytest.fixture(scope="module")
def shown():
    return answered(State(LINEAR), 1)


def test_the_tables_are_those_of_the_report(shown):
    design, table = shown.design, tables_of(shown)
    numbers = itertools.chain(*mf.report.numbers(design))
    for words in (*numbers, mf.report.fit_table(design)[1][0][2], *map(str, remarks(shown))):
        assert words in table
    assert NOT_CURRENT in tables_of(replace(shown, problems={"limits.max_height": "is missing"}))
    empty = Answer(1, shown.state)
    assert NO_DESIGN in tables_of(empty)
    assert (remarks(empty), warnings_by_place(empty)) == ((), {})


def test_notes_are_told_where_their_remedies_are():
    answer = answered(State(TEXT), 1)
    assert answer.no_part == ""
    notes = (
        Note("the caps", remedies=("load_range",)),
        Note("a word", remedies=("pitch", "model")),
        Note("no <remedy>"),
        information("found in 3 steps", remedies=("radius",)),
    )
    noted = replace(answer, design=replace(answer.design, notes=notes))
    places = warnings_by_place(noted)
    assert places["law"] == ["the caps", "no <remedy>"]
    assert places["target.load_range"] == ["the caps"]
    assert places["surface"] == places["lattice.pitch"] == places["model.kind"] == ["a word"]
    assert "lattice.radius" not in places
    assert remarks(noted) == mf.report.all_notes(noted.design)
    table = tables_of(noted)
    assert "3 warnings, 1 note on the design" in table
    assert "Warning: no &lt;remedy&gt;" in table
    low = with_height(answer, 7, 0.0)
    assert low.no_part in warnings_by_place(low)["surface"]
    refused = answered(State(TEXT.replace('"1.68 mm^2"', '"3.9 mm^2"')), 2, low)
    assert warnings_by_place(refused) == {}  # those of an earlier surface


def test_the_band_is_that_of_made_surfaces(shown, monkeypatch):
    design = shown.design
    load, low, high = certainty.tolerance_band(shown)
    assert load[-1] == design.law.rescaled_load[-1]
    height = mf.Tolerances(height_sd=0.0009).perturbed(design.surface, 10_000, np.random.default_rng(1))[0]
    areas = design.law.model.areas(design.surface, load, height)
    assert (low + high) / 2 == pytest.approx(areas.mean(axis=0), rel=0.01)
    assert (high - low) / 2 == pytest.approx(areas.std(axis=0), rel=0.2)  # five standard errors of 256 draws
    for without in (answered(State(EXACT), 1), Answer(1, shown.state)):
        assert certainty.tolerance_band(without) is None
    monkeypatch.setattr(tolerances, "MOST", design.surface.count - 1)
    assert certainty.tolerance_band(answered(State(LINEAR), 1)) is None


def test_the_commands_of_studies_are_those_of_the_program():
    for command in STUDIES:
        program, *words = command.split()
        assert (program, CliRunner().invoke(main, [*words, "--help"]).exit_code) == ("metafem", 0)
