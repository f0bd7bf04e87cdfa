"""Files that the page hands out are those of ``metafem design``."""

import io
import zipfile
from dataclasses import replace
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from metafem.cli import main
from metafem.explorer.answer import answered
from metafem.explorer.session import State
from metafem.explorer.take.files import (
    archive,
    command_of,
    law_picture,
    made_files,
    specification_file,
    tables_of,
)
from metafem.files import demo_text, read_spec
from tests.explorer.scenes import SAMPLED, WANTED

STATE = State(SAMPLED, {"wanted.csv": WANTED})


def test_the_picture_of_the_law_is_an_svg_file_with_its_axes():
    design = answered(State(demo_text("operating-points")), 1).design
    picture = law_picture(design).decode("utf-8")
    assert ElementTree.fromstring(picture).tag == "{http://www.w3.org/2000/svg}svg"
    assert design.target.title in picture
    assert "P/E" in picture


def designed(state, folder):
    """Run the command of the page on the specification that it hands out, and return the files."""
    name, content = specification_file(state)
    if name.endswith(".zip"):
        zipfile.ZipFile(io.BytesIO(content)).extractall(folder)
    else:
        (folder / name).write_bytes(content)
    words = command_of(state).split(" && ")[-1].split()[1:]
    done = CliRunner().invoke(main, [*words[:-1], str(folder / words[-1])])
    assert done.exit_code in (0, 1), done.output
    return {path.name: path.read_bytes() for path in (folder / words[-1]).iterdir()}


@pytest.mark.slow
@pytest.mark.parametrize("state", [State(demo_text("operating-points")), STATE], ids=["demo", "table"])
def test_tables_are_those_of_the_command_to_the_byte(state, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    files = designed(state, tmp_path)
    tables = tables_of(answered(state, 1))
    assert list(tables) == ["heights.csv", "law.csv", "mould.csv"]
    assert {name: files[name] for name in tables} == tables


@pytest.mark.slow
def test_all_files_are_those_of_the_command_to_the_byte(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made = made_files(STATE)
    assert made == designed(STATE, tmp_path)
    assert {"report.html", "spec.toml", "wanted.csv", ".metafem-files"} <= made.keys()


OUTSIDE = [
    "../wanted.csv",
    "a/../../wanted.csv",
    "/etc/wanted.csv",
    "..\\wanted.csv",
    "C:wanted.csv",
    "spec.toml",
]


@pytest.mark.parametrize("name", OUTSIDE)
def test_tables_of_a_link_are_not_unpacked_elsewhere(name, tmp_path):
    text = SAMPLED.replace('"wanted.csv"', f"'{name}'")
    state = State(text, {name: WANTED})
    packed, content = specification_file(state)
    assert packed == "specification.zip"
    names = zipfile.ZipFile(io.BytesIO(content)).namelist()
    assert names[0] == "spec.toml"
    assert len(set(names)) == 2
    assert not any("/" in each or ".." in each for each in names)
    zipfile.ZipFile(io.BytesIO(content)).extractall(tmp_path)
    assert read_spec(tmp_path / "spec.toml").design() == answered(state, 1).design
    broken = specification_file(replace(state, text=text + "["))[1]
    assert zipfile.ZipFile(io.BytesIO(broken)).namelist() == ["spec.toml"]


def test_tables_in_folders_keep_their_names():
    state = State(SAMPLED.replace("wanted.csv", "tables/wanted.csv"), {"tables/wanted.csv": WANTED})
    names = zipfile.ZipFile(io.BytesIO(specification_file(state)[1])).namelist()
    assert sorted(names) == ["spec.toml", "tables/wanted.csv"]


def test_a_text_that_is_no_utf8_is_handed_out_all_the_same():
    assert specification_file(State("# \ud800")) == ("spec.toml", b"# ?")
    packed = specification_file(State("# \ud800", {"a.csv": "\ud800"}))[1]
    assert zipfile.ZipFile(io.BytesIO(packed)).read("a.csv") == b"?"


def test_equal_files_give_equal_archives():
    files = {"a.csv": b"1\n" * 1000, "b.csv": b"2\n"}
    assert archive(files) == archive(dict(files))
    read = zipfile.ZipFile(io.BytesIO(archive(files)))
    assert {name: read.read(name) for name in read.namelist()} == files
    assert read.testzip() is None


def test_a_refused_state_has_no_tables_but_its_specification():
    state = State(demo_text("linear").replace("6.87", "-1.0"))
    assert tables_of(answered(state, 1, answered(STATE, 0))) == {}
    assert specification_file(state) == ("spec.toml", state.text.encode("utf-8"))
