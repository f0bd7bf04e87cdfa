"""All files that the page hands out are those of ``metafem design``."""

import re

import pytest

from metafem.explorer.answer import answered
from metafem.explorer.session import State
from metafem.explorer.take.figure import figure_files
from metafem.explorer.take.files import made_files, tables_of
from metafem.files import demo_text
from tests.core.explorer.test_files import STATE, files_of_command


def test_all_files_are_those_of_the_command_to_the_byte(tmp_path, monkeypatch):
    made = made_files(STATE)
    assert made == files_of_command(tmp_path, monkeypatch)
    assert {"report.html", "spec.toml", "wanted.csv", ".metafem-files"} <= made.keys()


@pytest.mark.parametrize(
    ("kind", "width", "size"), [("svg", "85,5", (85.5, 120)), ("pdf", " 170 mm", (170, 120))]
)
def test_a_figure_has_its_size_caption_and_data(kind, width, size):
    answer = answered(State(demo_text("operating-points")), 1)
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
