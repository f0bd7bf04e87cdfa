"""How sure a design is: its numbers, the band of made surfaces, and warnings at their places."""

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
    numbers_of,
    remarks,
    tables_of,
    warnings_by_place,
)
from metafem.explorer.history import State
from metafem.files import demo_text
from metafem.notes import Note, information
from metafem.prediction.validity import BASE, base_contact_load
from tests.explorer.scenes import with_height

LINEAR, TEXT = demo_text("linear"), demo_text("operating-points")
EXACT = LINEAR.replace('height_sd = "0.9 um"', "")


@pytest.fixture(scope="module")
def shown():
    return answered(State(LINEAR), 1)


def differences(design, load, step=1e-7):
    """Return the changes (n, k) of the areas at loads with each height."""
    surface = design.surface
    heights = surface.height + step * np.vstack([np.eye(surface.count), -np.eye(surface.count)])
    plus, minus = np.split(design.law.model.areas(surface, load, heights), 2)
    return (plus - minus) / (2 * step)


def test_the_tables_are_those_of_the_report(shown, monkeypatch):
    design, numbers = shown.design, dict(numbers_of(shown, shown.design))
    name, value = mf.report.misfit_words(design)
    assert numbers[name] == f"{value}; up to 10 % is good"
    onset = design.surface.material.composite_modulus * base_contact_load(design.surface, design.law.model)
    assert numbers[BASE].startswith(f"{onset:.3g} N")
    assert "0.9 µm" in numbers["band of the law"]
    table = tables_of(shown)
    for words in (mf.report.fit_table(design)[1][0][2], *map(str, remarks(shown))):
        assert words in table
    assert NOT_CURRENT in tables_of(replace(shown, problems={"limits.max_height": "is missing"}))
    empty = Answer(1, shown.state)
    assert NO_DESIGN in tables_of(empty)
    assert (remarks(empty), warnings_by_place(empty)) == ((), {})

    def fails(*given):
        raise mf.NotConverged("no solution at 3 N")

    monkeypatch.setattr("metafem.explorer.certainty.base_contact_load", fails)
    assert dict(numbers_of(shown, design))[BASE] == "unknown: no solution at 3 N"


def test_notes_are_told_where_their_remedies_are():
    answer = answered(State(TEXT), 1)
    assert "take" not in warnings_by_place(answer)
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
    assert warnings_by_place(low)["take"] == [low.no_part]
    assert low.no_part in warnings_by_place(low)["surface"]
    refused = answered(State(TEXT.replace('"1.68 mm^2"', '"3.9 mm^2"')), 2, low)
    assert warnings_by_place(refused) == {}  # those of an earlier surface


def test_the_band_is_that_of_differences_of_the_law(shown, monkeypatch):
    design = shown.design
    load, low, high = certainty.tolerance_band(shown)
    assert load[-1] == design.law.rescaled_load[-1]
    assert (low + high) / 2 == pytest.approx(design.law.area[::-3][::-1], rel=1e-12)
    sd = 0.0009 * np.linalg.norm(differences(design, load), axis=0)
    assert (high - low) / 2 == pytest.approx(sd, rel=1e-4)
    for without in (answered(State(EXACT), 1), Answer(1, shown.state)):
        assert certainty.tolerance_band(without) is None
        assert certainty.band_words(without) == ""
    monkeypatch.setattr(certainty, "MOST_ALONE", design.surface.count - 1)
    assert certainty.tolerance_band(answered(State(LINEAR), 1)) is None


def test_the_commands_of_studies_are_those_of_the_program():
    for command in STUDIES:
        program, *words = command.split()
        assert (program, CliRunner().invoke(main, [*words, "--help"]).exit_code) == ("metafem", 0)
