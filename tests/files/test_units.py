import re
from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from metafem.errors import InvalidInput
from metafem.files import units
from metafem.files.units import EXAMPLES, USUAL, converted, decimal, pattern, quantity


@pytest.mark.parametrize(
    "text", ["526 um", "526 \u00b5m", "526 \u03bcm", "526um", " 0.526 mm ", "5.26e-4 m", "526 microns"]
)
def test_one_length_in_many_spellings(text):
    assert quantity("lattice.radius", text, "mm") == 0.526


@pytest.mark.parametrize("text", ["0.5 mm^2", "0.5 mm2", "0.5 mm**2", "0.5 mm²", "0.5 mm*mm", "500000 µm²"])
def test_one_area_in_many_spellings(text):
    assert quantity("target.crossover_load", text, "mm^2") == 0.5


@pytest.mark.parametrize(("text", "unit", "value"), [
    ("1.36 N/mm^2", "MPa", 1.36),
    ("1360 kPa", "MPa", 1.36),
    ("200 mN", "N", 0.2),
    ("85 %", "%", 0.85),
    ("3%", "%", 0.03),
    ("0.85", "1", 0.85),
    ("180 deg", "rad", 3.141592653589793),
])  # fmt: skip
def test_units_of_every_dimension(text, unit, value):
    assert quantity("key", text, unit) == value


def refusal(unit):
    return "is a number without unit" if unit == "1" else f"does not measure in {re.escape(unit)}"


def test_usual_units_are_as_pint_has_them(monkeypatch):
    usual = dict(units._KNOWN)
    units.factor.cache_clear()
    monkeypatch.setattr(units, "_KNOWN", {})
    for name, (own, size) in usual.items():
        assert units.factor(name, own) == size
        for other in EXAMPLES.keys() - {own}:
            with pytest.raises(InvalidInput, match=refusal(other)):
                units.factor(name, other)
    units.factor.cache_clear()


@pytest.mark.parametrize(("text", "unit"), [("85 %", "1"), ("5 %", "rad"), ("3 deg", "%"), ("1 rad", "1")])
def test_ratios_shares_and_angles_are_not_taken_for_one_another(text, unit):
    with pytest.raises(InvalidInput, match=refusal(unit)):
        quantity("key", text, unit)


@given(st.decimals(min_value=-(10**6), max_value=10**6, places=4))
def test_micrometres_are_rounded_once(number):
    assert quantity("key", f"{number} um", "mm") == float(number * Decimal("0.001"))


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_decimal_reads_what_str_writes(number):
    assert float(decimal(str(number))) == number


@pytest.mark.parametrize(("given_", "cause"), [
    (120.0, "needs a unit"),
    ("120", "needs a unit"),
    (["1 mm"], "must be a text"),
    ("120 foo", 'unknown unit "foo"'),
    ("120 MPa", "does not measure in mm"),
    ("um", "does not begin with a number"),
    ("nan mm", "does not begin with a number"),
    ("", "does not begin with a number"),
    ("1,5 mm", "unknown unit"),
    ("9**9**9**9 mm", "unknown unit"),
    ("1 mm**9**9**9", "unknown unit"),
    ("1 mm/", "unknown unit"),
    ("1 " + "m " * 5000, "unknown unit"),
    ("1e999 mm", "too large"),
])  # fmt: skip
def test_a_refusal_names_key_value_and_example(given_, cause):
    with pytest.raises(InvalidInput) as error:
        quantity("limits.max_height", given_, "mm")
    message = str(error.value)
    assert message.startswith("limits.max_height = ")
    assert cause in message
    assert '"120 um"' in message


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
