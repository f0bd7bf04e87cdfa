"""Files that were changed in a result folder are named, and what is stated follows from the heights."""

import json

import numpy as np
import pytest

import metafem as mf
from metafem.files.atomic import MANIFEST
from metafem.files.result import changes
from metafem.files.result.folder import load_compared

TEMPLATE = mf.Surface.square_lattice(0.2, (4, 4), radius=0.526, material=mf.Material(1.36))
POINTS = mf.OperatingPoints([0.02, 0.05], [0.2, 0.45])

# Designs of each kind of comparison: of points, of slopes, and of a line with its range of loads.
DESIGNS = {
    "points": lambda: mf.design(POINTS, TEMPLATE, limits=mf.Limits(0.16)),
    "linear": lambda: mf.design(mf.LinearLaw(7.0), TEMPLATE, limits=mf.Limits(0.16)),
    "bilinear": lambda: mf.design(mf.BilinearLaw((7.0, 11.0), 0.01), TEMPLATE, limits=mf.Limits(0.16)),
    "line-layer": lambda: mf.design(
        mf.LinearLaw(7.0, (0.02, 0.045)),
        TEMPLATE.replaced(block=mf.Block(20, 20, 7.2)),
        mf.Interacting(substrate=mf.BondedLayer()),
        mf.Limits(0.16),
    ),
}


@pytest.fixture
def folder(tmp_path):
    """Return the folder of an exact design of heights up to 0.16 mm."""
    mf.save(DESIGNS["points"](), tmp_path / "out")
    return tmp_path / "out"


def edit(folder, change):
    """Change the design in design.json as with an editor."""
    record = json.loads((folder / "design.json").read_text())
    change(record["design"])
    (folder / "design.json").write_text(json.dumps(record))


def heighten(design):
    heights = design["surface"]["height"]["float64"]
    heights[int(np.argmax(heights))] += 0.03


def worse(design):
    design["misfit"] = 0.5


def thin(design):
    area = design["law"]["area"]["float64"]
    area[:] = [1.01 * value for value in area]


@pytest.mark.parametrize("listed", [True, False])
def test_a_changed_height_is_noticed_and_the_misfit_is_that_of_the_heights(folder, listed):
    before = mf.load(folder)
    assert load_compared(folder)[1] == ()
    edit(folder, heighten)
    if not listed:  # a copy of the folder without its hidden files
        (folder / MANIFEST).unlink()
    design, notes = load_compared(folder)
    first, second = (note.text for note in notes)
    assert first.startswith(str(folder / "design.json"))
    assert ("was changed since metafem wrote it" if listed else "does not fit together") in first
    assert "it states below 1e-9; law and misfit are computed anew" in first
    assert second.endswith("heights outside its limits, from 0 to 0.16 mm")
    assert design.notes[:2] == notes
    assert all(note.warns for note in notes)
    assert (before.status.name, design.status.name) == ("EXACT", "MISSED")
    law = mf.friction_law(design.surface, design.law.model, load=design.law.load)
    np.testing.assert_allclose(design.law.area, law.area, rtol=1e-12)
    assert design.misfit > 0.05


@pytest.mark.parametrize("change", [worse, thin])
@pytest.mark.parametrize("listed", [True, False])
def test_a_changed_misfit_or_law_is_computed_anew(folder, change, listed):
    before = mf.load(folder)
    edit(folder, change)
    if not listed:
        (folder / MANIFEST).unlink()
    design, (note,) = load_compared(folder)
    assert "law and misfit are computed anew" in note.text
    assert design.misfit < 1e-9
    np.testing.assert_allclose(design.law.area, before.law.area, rtol=1e-12)


def test_a_change_that_leaves_the_law_is_named_all_the_same(folder):
    before = mf.load(folder)
    edit(folder, lambda design: design["notes"].clear())
    design, (note,) = load_compared(folder)
    assert note.text.endswith("the misfit of its heights is below 1e-9, as it states")
    np.testing.assert_array_equal(design.law.area, before.law.area)


@pytest.mark.parametrize(
    ("kind", "change"),
    [
        ("linear", lambda target: target.update(slope=9.5)),
        ("bilinear", lambda target: target.update(crossover_load=0.02)),
        ("line-layer", lambda target: target.update(slope=9.5)),
    ],
)
def test_heights_that_were_designed_for_another_target_are_named(tmp_path, kind, change):
    folder = tmp_path / "out"
    mf.save(DESIGNS[kind](), folder)
    edit(folder, lambda design: change(design["target"]))
    note, *others = (note.text for note in load_compared(folder)[1])
    assert "its heights were designed for slope" in note
    assert note.endswith("; run metafem design again")
    assert not any("as it states" in other for other in others)


def test_changed_heights_keep_no_note_or_level_of_the_inversion(folder):
    made_by_hand = {"type": "Note", "text": "made by hand", "level": {"type": "Level", "name": "WARNING"}}
    edit(folder, lambda design: (heighten(design), design["notes"].append(made_by_hand)))
    design, notes = load_compared(folder)
    assert design.notes == (*notes, *design.law.notes)
    assert design.parameters.keys().isdisjoint({"counts", "levels"})


def test_notes_on_a_folder_stay_in_it(folder):
    edit(folder, heighten)
    design, notes = load_compared(folder)
    mf.save(design, folder.with_name("new"))
    assert mf.load(folder.with_name("new")).notes == design.notes[len(notes) :]


def test_a_changed_table_is_named_and_the_record_counts(folder):
    before = mf.load(folder)
    for name in ("heights.csv", "law.csv"):
        text = (folder / name).read_text()
        (folder / name).write_text(text.replace("0.1", "0.2"))
    design, notes = load_compared(folder)
    assert [note.text for note in notes] == [
        f"{folder / name} was changed since metafem wrote it; the design of design.json counts"
        for name in ("heights.csv", "law.csv")
    ]
    assert design.surface == before.surface
    assert design.misfit == before.misfit


def test_missing_tables_and_files_of_the_user_are_no_alarm(folder):
    (folder / "heights.csv").unlink()
    (folder / "mine.csv").write_text("x")
    assert load_compared(folder)[1] == ()
    (folder / "design.json").unlink()
    with pytest.raises(mf.InvalidInput, match="no such file"):
        mf.load(folder)


def test_heights_without_a_law_are_named(folder, monkeypatch):
    def failing(design):
        raise mf.NotConverged("no solution at 1 N")

    edit(folder, heighten)
    monkeypatch.setattr(changes, "reassessed", failing)
    (note,) = load_compared(folder)[1]
    assert note.text.endswith("metafem wrote it: the law of its heights is not found (no solution at 1 N)")


@pytest.mark.parametrize(("height", "words"), [(5.0, "higher than their radius"), (-5.0, "below the base")])
def test_a_height_that_no_part_has_is_a_warning(folder, height, words):
    edit(folder, lambda design: design["surface"]["height"]["float64"].__setitem__(0, height))
    design = mf.load(folder)
    assert any("outside its limits" in note.text for note in design.notes)
    assert any(words in note.text and note.warns for note in design.notes)
    law = mf.friction_law(design.surface, load=[0.01])
    assert any(words in note.text for note in law.notes)


@pytest.mark.parametrize("kind", DESIGNS)
def test_a_copy_of_a_result_without_its_hidden_files_is_no_alarm(tmp_path, kind):
    mf.save(DESIGNS[kind](), tmp_path / "out")
    (tmp_path / "out" / MANIFEST).unlink()
    assert load_compared(tmp_path / "out")[1] == ()
