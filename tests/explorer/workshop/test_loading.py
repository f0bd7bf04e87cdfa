"""Files that are loaded: a specification with its tables, and a clear reason for everything else."""

import pytest

from metafem.errors import InvalidInput
from metafem.explorer.session import State
from metafem.explorer.workshop.loading import Given, loaded, table_names
from metafem.files import demo_text

STATE = State(demo_text("linear"), measured="load_N,friction_force_N\n1,2\n", measured_name="m.csv")
SAMPLED = '[target]\nkind = "sampled"\nfile = "laws/wanted.csv"\n'
TABLE = "load_N,friction_force_N\n0.1,0.2\n"


def test_a_specification_replaces_the_text_and_leaves_the_rest():
    found = loaded(STATE, [Given("linear.toml", demo_text("bilinear"))])
    assert (found.text, found.tables, found.measured) == (demo_text("bilinear"), {}, STATE.measured)


def test_of_a_result_folder_only_the_named_tables_are_kept():
    folder = [Given("spec.toml", SAMPLED), Given("wanted.csv", TABLE), Given("heights.csv", "x\n1\n")]
    found = loaded(STATE, folder)
    assert found.tables == {"laws/wanted.csv": TABLE}
    assert loaded(found, [Given("wanted.csv", TABLE * 2)]).tables == {"laws/wanted.csv": TABLE * 2}
    assert loaded(STATE, [Given("other.toml", "[a]"), *folder]).text == SAMPLED


def test_a_specification_with_errors_is_loaded_to_be_repaired():
    assert loaded(STATE, [Given("mine.toml", "[limits]\nmax_height = \n")]).text.startswith("[limits]")


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ([Given("photo.png", why="is not a text in UTF-8")], "photo.png is not a text in UTF-8. Load a"),
        ([Given("report.html", "<!doctype html>")], "report.html is no specification. Load a .toml file"),
        ([Given("pyproject.toml", '[project]\nname = "x"')], "pyproject.toml is no specification: it"),
        ([Given("page.toml", "<!doctype html>")], "page.toml is no specification: it"),
        ([Given("law.csv", TABLE)], "The specification names no table. To use it, write file = \"law.csv\""),
        ([Given("a.toml", SAMPLED), Given("b.toml", SAMPLED)], "several specifications"),
        ([], "Load a .toml file"),
        ([Given("blank.toml", "\n" * 100_000)], "blank.toml is no specification"),
        (
            [Given("a.toml", SAMPLED), Given("wanted.csv", why="is not a text in UTF-8")],
            "a.toml names the table wanted.csv, which is not a text in UTF-8.",
        ),
    ],
)  # fmt: skip
def test_other_files_are_refused_with_what_to_load(files, words):
    with pytest.raises(InvalidInput) as caught:
        loaded(STATE, files)
    assert words in str(caught.value)


def test_the_tables_of_a_text():
    cap = '[contact]\nkind = "jkr"\ncap = {kind = "profile", file = "cap.csv"}'
    assert table_names(SAMPLED + cap) == ("laws/wanted.csv", "cap.csv")
    assert table_names("[target") == ()
    assert table_names("target = 3\n[contact]\nfile = 4") == ()
