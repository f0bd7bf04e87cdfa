"""What all claims together show: printed numbers that are counted once, and the tables of the README."""

import pytest

from tests.validation.test_claims import EVALUATED, LONG
from validation.__main__ import MARKS, PRINTED_MARKS, is_slow
from validation.page import readme_table
from validation.readme import README
from validation.results import Evaluated
from validation.verdicts import PRINTED, QUESTIONS, printed_table


@pytest.mark.parametrize("which", ["quick", pytest.param("all", marks=pytest.mark.slow)])
def test_each_printed_number_is_counted_once(which, evaluated):
    found = [evaluated(name) for name in EVALUATED if which == "all" or not (is_slow(name) or name in LONG)]
    numbers = [(check.source.text, check.source.quantity) for claim in found for check in claim.numbers]
    assert len(numbers) > 15
    assert sorted(numbers) == sorted(set(numbers))


@pytest.mark.slow
def test_the_table_of_the_readme_is_the_one_that_is_computed(evaluated):
    readme = README.read_text("utf-8")
    shown = readme.partition(MARKS[0])[2].partition(MARKS[1])[0].splitlines()
    # times are measured on their own, and the tests solve fewer scenes: those answers are not compared
    found = {name: evaluated(name) for name in EVALUATED if name not in ("random_scenes", "stability_map")}
    results = {
        name: Evaluated(name, claim.title, "", claim.text, tuple(claim.rows), (), 0.0)
        for name, claim in found.items()
    }
    lines = [line for line in readme_table(results).splitlines() if "left out of this run" not in line]
    assert len(lines) == 2 + len(QUESTIONS) - 3  # cost, exactness and random scenes
    assert set(lines) <= set(shown)


@pytest.mark.slow
def test_the_printed_numbers_of_the_readme_are_the_computed_ones(evaluated):
    names = {claim for line in PRINTED for claim, *_ in line["rows"]}
    table = printed_table({name: evaluated(name) for name in names})
    begin, end = PRINTED_MARKS
    assert f"{begin}\n{table}\n{end}" in README.read_text("utf-8")
