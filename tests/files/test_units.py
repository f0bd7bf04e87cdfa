import re
from decimal import Decimal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from metafem.errors import InvalidInput
from metafem.files.units import converted, decimal, pattern, quantity


@given(st.decimals(min_value=-(10**6), max_value=10**6, places=4))
def test_micrometres_are_rounded_once(number):
    assert quantity("key", f"{number} um", "mm") == float(number * Decimal("0.001"))


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_decimal_reads_what_str_writes(number):
    assert float(decimal(str(number))) == number


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
