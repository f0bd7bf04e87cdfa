"""Files that the page hands out, and those that it cannot; and the specification of a new part."""

import io
import zipfile
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner

from metafem.cli import main
from metafem.errors import MetafemError
from metafem.explorer.answer import Answer, answered
from metafem.explorer.files import (
    NO_DESIGN,
    archive,
    command_of,
    hindrance,
    made_files,
    quick_files,
    said_above,
    specification_file,
)
from metafem.explorer.history import State
from metafem.explorer.new_part import FIRST, new_part
from metafem.explorer.table import with_values
from metafem.files import demo_text, of_table, read_spec
from tests.explorer.scenes import SAMPLED, WANTED, changed

TEXT = demo_text("operating-points")
STATE = State(SAMPLED, {"wanted.csv": WANTED})


@pytest.fixture(scope="module")
def answer():
    return answered(State(TEXT), 1)


def names_of(content):
    return zipfile.ZipFile(io.BytesIO(content)).namelist()


def files_of_command(tmp_path, monkeypatch):
    """Return the files that the command makes which the page shows."""
    monkeypatch.chdir(tmp_path)
    zipfile.ZipFile(io.BytesIO(specification_file(STATE)[1])).extractall(tmp_path)
    words = command_of(STATE).split(" && ")[-1].split()[1:]
    done = CliRunner().invoke(main, [*words[:-1], str(tmp_path / words[-1])])
    assert done.exit_code in (0, 1), done.output
    return {path.name: path.read_bytes() for path in (tmp_path / words[-1]).iterdir()}


def test_the_tables_are_those_of_the_command_that_the_page_shows(tmp_path, monkeypatch):
    assert sorted(names_of(specification_file(STATE)[1])) == ["spec.toml", "wanted.csv"]
    found = answered(STATE, 1)
    tables = quick_files(found)
    assert list(tables) == ["heights.csv", "law.csv", "mould.csv", "law.svg"]
    picture = tables.pop("law.svg").decode("utf-8")
    assert ElementTree.fromstring(picture).tag == "{http://www.w3.org/2000/svg}svg"
    assert found.design.target.title in picture
    assert tables.items() <= files_of_command(tmp_path, monkeypatch).items()


@pytest.mark.slow
def test_all_files_are_those_of_the_command_to_the_byte(tmp_path, monkeypatch):
    made = made_files(answered(STATE, 1))
    assert made == files_of_command(tmp_path, monkeypatch)
    assert {"report.html", "spec.toml", "wanted.csv"} <= made.keys()


@pytest.mark.parametrize("name", ["../wanted.csv", "/etc/wanted.csv", "..\\wanted.csv", "C:wanted.csv"])
def test_tables_of_a_link_are_not_unpacked_elsewhere(name, tmp_path):
    state = State(SAMPLED.replace('"wanted.csv"', f"'{name}'"), {name: WANTED})
    content = specification_file(state)[1]
    names = names_of(content)
    assert names == ["wanted.csv", "spec.toml"]
    zipfile.ZipFile(io.BytesIO(content)).extractall(tmp_path)
    assert read_spec(tmp_path / "spec.toml").target.rescaled_load[-1] == 0.05


def test_texts_archives_and_pictures(answer):
    assert names_of(specification_file(State(TEXT, {"..": WANTED}))[1]) == ["spec.toml"]
    assert specification_file(State("# \ud800")) == ("spec.toml", b"# ?")
    files = {"a.csv": b"1\n" * 1000, "b.csv": b"2\n"}
    read = zipfile.ZipFile(io.BytesIO(archive(files)))
    assert {name: read.read(name) for name in read.namelist()} == files
    assert archive(files) == archive(dict(files))
    refused = State(demo_text("linear").replace("6.87", "-1.0"))
    with pytest.raises(MetafemError, match="no design"):
        quick_files(answered(refused, 1, answer))


def test_what_hinders_a_file_is_told(answer):
    every = ["mould.csv", "heights.csv", "law.csv", "block.stl", "mould.stl", "surface.zip"]

    def hindered(answer, problem=""):
        return [name for name in every if hindrance(name, answer, problem) is not None]

    assert (hindered(answer), said_above(answer)) == ([], "")
    problem = "no part can be made: asperity 7 has the height 0 mm"
    assert hindered(answer, problem) == [name for name in every if name not in ("heights.csv", "law.csv")]
    assert "height 0 mm" in said_above(answer, problem)
    bare = answered(State(changed(TEXT, with_values, {"part": None, "block": None})), 2)
    assert hindered(bare) == ["block.stl", "mould.stl"]
    assert "“Block”" in hindrance("block.stl", bare)
    none = Answer(1, State(TEXT), refusal="the target ends above the reach")
    assert hindered(none) == every
    assert said_above(none) == f"{NO_DESIGN} the target ends above the reach"


def test_the_values_of_a_new_part_are_those_of_its_specification():
    table = new_part(FIRST)
    found = answered(State("").edited(table), 1)
    assert (found.current, found.no_part, found.template.count) == (True, "", 64)
    assert found.design.law.friction_coefficient[50] == pytest.approx(1.5, rel=0.05)
    assert table["limits"]["max_height"] == "263 um"
    in_units = {"radius": "0,526 mm", "modulus": "1360 kPa", "size": "20 20 7,2", "coefficient": "1,5"}
    assert of_table(new_part(FIRST | in_units)).template == found.template
    young = of_table(new_part(FIRST | {"young": "1,02", "loads": "0,1-1e-0"}))
    assert young.template.material.composite_modulus == pytest.approx(1.36)
    assert young.target.load_range == pytest.approx((0.1 / 1.36, 1.0 / 1.36))
    assert new_part(FIRST | {"asperities": "9 x 6"})["lattice"]["pitch"] == "2.222 mm"
    soft = answered(State("").edited(new_part(FIRST | {"modulus": "soft", "coefficient": "much"})), 2)
    assert set(soft.problems) == {"material.composite_modulus", "target.friction_coefficient"}
