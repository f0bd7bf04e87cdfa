"""Files that cannot be taken, and the reasons."""

import pytest

from metafem.explorer.answer import Answer, answered
from metafem.explorer.session import State
from metafem.explorer.take.files import NO_DESIGN, hindrance, said_above
from metafem.explorer.workshop.changes import without_section
from metafem.files import demo_text

TEXT = demo_text("operating-points")
FILES = (
    "mould.csv",
    "heights.csv",
    "law.csv",
    "block.stl",
    "mould.stl",
    "mould.svg",
    "surface.zip",
    "report.html",
)
PROBLEM = "no part can be made: asperity 7 has the height 0 mm"


@pytest.fixture(scope="module")
def answer():
    """The answer to the demo."""
    return answered(State(TEXT), 1)


def hindered(answer, problem=""):
    """The files that cannot be taken."""
    return [name for name in FILES if hindrance(name, answer, problem)]


def test_all_files_of_a_design_with_a_block_can_be_taken(answer):
    assert hindered(answer) == []
    assert said_above(answer) == ""


def test_tables_of_the_design_can_be_taken_where_no_part_can_be_made(answer):
    assert hindered(answer, PROBLEM) == [name for name in FILES if name not in ("heights.csv", "law.csv")]
    assert said_above(answer, PROBLEM).startswith("No part can be made: asperity 7 has the height 0 mm. ")


def test_solids_need_a_block_and_their_format():
    bare = answered(State(without_section(without_section(TEXT, "part"), "block")), 2)
    assert hindered(bare) == ["block.stl", "mould.stl", "mould.svg"]
    assert "“Block”" in hindrance("block.stl", bare)
    other = answered(State(TEXT + 'formats = ["3mf"]\n'), 3)
    assert hindered(other) == ["block.stl", "mould.stl"]
    assert hindrance("mould.stl", other) == "needs “stl” among the “formats” of “Part files”"


def test_nothing_can_be_taken_without_a_surface():
    none = Answer(1, State(TEXT), refusal="the target ends above the reach")
    assert hindered(none) == list(FILES)
    assert said_above(none) == f"{NO_DESIGN} the target ends above the reach"
