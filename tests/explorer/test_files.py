"""All files that the page hands out are those of ``metafem design``."""

import io
import re
import zipfile

import pytest
from click.testing import CliRunner

from metafem.cli import main
from metafem.explorer.answer import answered
from metafem.explorer.session import State
from metafem.explorer.take.figure import figure_files
from metafem.explorer.take.files import command_of, made_files, specification_file, tables_of
from metafem.files import demo_text
from tests.explorer.scenes import SAMPLED, WANTED

STATE = State(SAMPLED, {"wanted.csv": WANTED})


def test_all_files_are_those_of_the_command_to_the_byte(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    zipfile.ZipFile(io.BytesIO(specification_file(STATE)[1])).extractall(tmp_path)
    words = command_of(STATE).split(" && ")[-1].split()[1:]
    done = CliRunner().invoke(main, [*words[:-1], str(tmp_path / words[-1])])
    assert done.exit_code in (0, 1), done.output
    made = made_files(STATE)
    assert made == {path.name: path.read_bytes() for path in (tmp_path / words[-1]).iterdir()}
    assert {"report.html", "spec.toml", "wanted.csv", ".metafem-files"} <= made.keys()


def test_a_figure_has_its_size_caption_and_data():
    answer = answered(State(demo_text("operating-points")), 1)
    assert_sized(answer, "svg", "85,5", (85.5, 120))
    assert_sized(answer, "pdf", " 170 mm", (170, 120))


def assert_sized(answer, kind, width, size):
    files = figure_files(answer, kind, width, "120mm")
    assert list(files) == [f"figure.{kind}", "caption.txt", "law.csv", "heights.csv"]
    text = files[f"figure.{kind}"].decode("latin-1")
    svg = r'<svg [^>]*?{}="(\S+)pt"'
    patterns = (svg.format("width"), svg.format("height")) if kind == "svg" else (
        r"/MediaBox \[ 0 0 (\S+) ", r"/MediaBox \[ 0 0 \S+ (\S+) \]",
    )  # fmt: skip
    found = [25.4 / 72 * float(re.search(each, text)[1]) for each in patterns]  # points
    assert found == pytest.approx(size, abs=1e-5)
    if kind == "svg":
        drawn = files["figure.svg"].decode("utf-8")
        assert "load P [N]" in drawn
        assert "friction force F [N]" in drawn
    tables = tables_of(answer)
    assert (files["law.csv"], files["heights.csv"]) == (tables["law.csv"], tables["heights.csv"])
    caption = files["caption.txt"].decode("utf-8")
    for words in (
        "3 operating points", "[0.144, 0.336, 0.649]", "independent", "E* 1.36 MPa",
        "shear strength 0.37 MPa", "58 asperities", "64 sites", "radius 0.526 mm",
        "Largest height: 0.27 mm", "4.8 %",
    ):  # fmt: skip
        assert words in caption
