"""Figures of pages: colours of the page, small, the same to the byte, with their data."""

from urllib.parse import unquote

import pytest

from metafem.drawing import ACHIEVED, new_figure, svg
from metafem.drawing.inline import drawn, themed


@pytest.fixture
def figure():
    made = new_figure(5.0, 4.0)
    ax = made.add_subplot()
    ax.plot([0.0, 1.0 / 3.0], [1.0, 2.0], "o-", color=ACHIEVED, label='a "name" at 1.23456 & #5')
    ax.set_xlabel("load  P [N]")
    ax.legend()
    return made


def test_colours_are_those_of_the_page_and_stand_beside_them(figure):
    text = drawn(figure, "A law").svg
    for colour, variable in (("#000000", "--ink"), ("#ffffff", "--paper"), (ACHIEVED, "--achieved")):
        assert f"var({variable}, {colour})" in text
        assert text.count(colour) == text.count(f"var({variable}, {colour})")
    assert "var(" not in svg(figure, "A law")  # a file carries its own colours


def test_it_is_smaller_and_says_the_same(figure):
    plain = svg(figure, "A law")
    text = themed(plain)
    assert len(text) < 0.8 * len(plain)
    assert "at 1.23456 &amp; #5" in text  # digits of words stay
    assert text.count("<use") == plain.count("<use") > 0
    for reference in {part.split('"')[0] for part in plain.split('href="#')[1:]}:
        assert f'id="{reference}"' in text


def test_equal_data_give_equal_bytes_and_the_link_holds_the_table(figure):
    first, second = drawn(figure, "A law: µ / 2", "See"), drawn(figure, "A law: µ / 2", "See")
    assert first == second
    assert first.file_name == "a_law_2.csv"
    kind, _, data = first.link.partition(",")
    assert kind == "data:text/csv;charset=utf-8"
    assert unquote(data) == first.csv
    assert not set(data) & set("\"'<># \n")
