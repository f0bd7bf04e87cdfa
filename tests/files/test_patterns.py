"""Patterns of texts with units, against the parser of quantities."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from metafem.errors import InvalidInput
from metafem.files.units import EXAMPLES, USUAL, converted, pattern


@pytest.mark.parametrize(("unit", "name"), [(unit, name) for unit in USUAL for name in USUAL[unit]])
def test_the_parser_reads_every_listed_unit(unit, name):
    for spelling in {name, *(name.replace("^2", square) for square in ("2", "**2", "²"))}:
        assert re.search(pattern((unit,)), f"1.5 {spelling}")
        assert converted(f"1.5 {spelling}", unit) > 0.0
        others = [other for other in USUAL if other != unit]
        assert not any(re.search(pattern((other,)), f"1.5 {spelling}") for other in others)


def test_examples_match():
    assert all(re.search(pattern((unit,)), EXAMPLES[unit]) for unit in USUAL)


TEXTS = st.from_regex(r"[ \t]{0,2}[+-]?[0-9.]{0,5}(e[+-]?[0-9]{0,3})?[ ]?(um|mm|cm)?[ \n]?", fullmatch=True)


@given(text=st.one_of(TEXTS, st.from_regex(pattern(("mm",)))))
def test_whatever_matches_is_read(text):
    if re.search(pattern(("mm",)), text):
        value = converted(text, "mm")
        assert bool(re.search(pattern(("mm",), positive=True), text)) <= (value > 0.0)
    else:
        number = re.fullmatch(r"(?a)\s*([^um\s]*)\s*(um|mm|cm)\s*", text)
        if number is None:
            with pytest.raises(InvalidInput):
                converted(text, "mm")


@given(value=st.floats(1e-30, 1e30))
def test_numbers_above_zero_match_the_positive_pattern(value):
    text = f"{value!r} mm"
    assert re.search(pattern(("mm",), positive=True), text)
    assert not re.search(pattern(("mm",), positive=True), f"-{text}")
    assert not re.search(pattern(("mm",), positive=True), "0.0e5 mm")
