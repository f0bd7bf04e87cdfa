"""The figure for a paper: its files, its size, and what it says."""

import re

import pytest

from metafem.errors import InvalidInput
from metafem.explorer.answer import answered
from metafem.explorer.session import State
from metafem.explorer.take.figure import figure_files
from metafem.explorer.take.files import tables_of
from metafem.files import demo_text

# One point [mm], the unit of matplotlib's files.
POINT = 25.4 / 72


@pytest.fixture(scope="module")
def answer():
    return answered(State(demo_text("operating-points")), 1)


def size_of(name, content):
    """Return width and height [mm] of an SVG or PDF file."""
    text = content.decode("latin-1")
    pattern = r'<svg [^>]*?height="(\S+)pt"' if name.endswith("svg") else r"/MediaBox \[ 0 0 \S+ (\S+) \]"
    height = float(re.search(pattern, text)[1])
    pattern = r'<svg [^>]*?width="(\S+)pt"' if name.endswith("svg") else r"/MediaBox \[ 0 0 (\S+) "
    return POINT * float(re.search(pattern, text)[1]), POINT * height


@pytest.mark.parametrize(
    ("kind", "width", "height", "size"),
    [
        ("svg", "170", "75", (170, 75)),
        ("pdf", " 85 mm", "75", (85, 75)),
        ("svg", "85,5", "120mm", (85.5, 120)),
    ],
)
def test_the_figure_has_the_size_and_stands_with_its_caption_and_data(answer, kind, width, height, size):
    files = figure_files(answer, kind, width, height)
    assert list(files) == [f"figure.{kind}", "caption.txt", "law.csv", "heights.csv"]
    # matplotlib writes points with six decimals at most
    assert size_of(f"figure.{kind}", files[f"figure.{kind}"]) == pytest.approx(size, abs=1e-5)
    tables = tables_of(answer)
    assert (files["law.csv"], files["heights.csv"]) == (tables["law.csv"], tables["heights.csv"])
    assert figure_files(answer, kind, width, height) == files


def test_the_caption_states_all_parameters(answer):
    caption = figure_files(answer, "svg", "170", "75")["caption.txt"].decode("utf-8")
    for words in (
        "Friction law through 3 operating points.", "rescaled_load=[0.144, 0.336, 0.649]", "independent",
        "E* 1.36 MPa", "shear strength 0.37 MPa", "58 asperities", "64 sites", "radius 0.526 mm",
        "Largest height: 0.27 mm", "below 1e-9", "order 3 on the bonded layer: 4.8 %",
    ):  # fmt: skip
        assert words in caption


def test_the_axes_have_the_units_of_the_page(answer):
    rescaled = answered(State(answer.state.text, newtons=False), 2, answer)
    text = figure_files(rescaled, "svg", "85", "75")["figure.svg"].decode("utf-8")
    assert "load P/E* [mm²]" in text
    text = figure_files(answer, "svg", "85", "75")["figure.svg"].decode("utf-8")
    assert "load P [N]" in text
    assert "friction force F [N]" in text
    assert "mm²" not in text


@pytest.mark.parametrize(
    ("width", "height", "words"),
    [
        ("wide", "75", "^width = wide must be a number of millimetres from 40 to 400"),
        ("170", "", "^height =  must be a number of millimetres from 40 to 400"),
        ("39.9", "75", "^width = 39.9 must be"),
        ("85", "400.1", "^height = 400.1 must be"),
        ("nan", "75", "^width = nan must be"),
        ("70", "60", "^width = 70 must be at least 80 mm for a height of 60 mm"),
    ],
)
def test_a_size_that_is_no_number_too_small_or_too_large_is_refused_by_name(answer, width, height, words):
    with pytest.raises(InvalidInput, match=words):
        figure_files(answer, "svg", width, height)
