"""The README's table of printed numbers holds the numbers that are computed."""

import pytest

from validation.printed_numbers import CLAIMS, MARKS, printed_table
from validation.readme import README
from validation.results import evaluate


@pytest.mark.slow
def test_the_readme_shows_the_computed_numbers():
    table = printed_table({name: evaluate(name) for name in CLAIMS})
    assert f"{MARKS[0]}\n{table}\n{MARKS[1]}" in README.read_text("utf-8")
