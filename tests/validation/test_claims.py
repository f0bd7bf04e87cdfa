"""Each claim of the validation holds, and each check names a source."""

import re

import pytest

from validation import printed_numbers
from validation.__main__ import MARKS, claims, evaluate, is_slow
from validation.chapters import CHAPTERS
from validation.check import Picture
from validation.page import readme_table
from validation.readme import README
from validation.results import Evaluated, costs
from validation.sources import Source
from validation.verdicts import QUESTIONS

# Quick claims whose pictures still take seconds.
LONG = ("any_law", "fig_s3_manufacturing")

NAMES = [
    pytest.param(name, marks=pytest.mark.slow) if is_slow(name) or name in LONG else name for name in claims()
]

# Words that name no source.
VAGUE = re.compile(
    r"promise|recomputed|independent(ly)? comput|another (code|implementation)|^solved|^exact$|^target$", re.I
)


@pytest.mark.parametrize("name", NAMES)
def test_claim_holds(name):
    failed = [check for check in evaluate(name).checks if not check.passed]
    assert not failed


@pytest.mark.parametrize("name", NAMES)
def test_each_check_names_its_source(name):
    for check in evaluate(name).checks:
        assert isinstance(check.source, Source), check
        assert str(check.source).strip(), check.name
        assert not VAGUE.search(str(check.source)), check


@pytest.mark.parametrize("which", ["quick", pytest.param("all", marks=pytest.mark.slow)])
def test_each_printed_number_is_counted_once(which):
    found = [evaluate(name) for name in claims() if which == "all" or not is_slow(name)]
    numbers = [(check.source.text, check.source.quantity) for claim in found for check in claim.numbers]
    assert len(numbers) > 15
    assert sorted(numbers) == sorted(set(numbers))


@pytest.mark.parametrize("name", NAMES)
def test_each_figure_has_a_caption_and_each_claim_a_text(name):
    claim = evaluate(name)
    assert claim.text.count(".") >= 2
    for title, picture in claim.figures.items():
        assert isinstance(picture, Picture), title
        assert len(picture.caption.split()) > 10, title
        assert picture.caption.strip().endswith("."), title


@pytest.mark.slow
def test_the_table_of_the_readme_is_the_one_that_is_computed():
    readme = README.read_text("utf-8")
    shown = readme.partition(MARKS[0])[2].partition(MARKS[1])[0].splitlines()
    # times are measured on their own, and the tests solve fewer scenes: those answers are not compared
    found = {name: evaluate(name) for name in claims() if name not in ("random_scenes", "stability_map")}
    results = {
        name: Evaluated(name, claim.title, "", claim.text, tuple(claim.rows), (), 0.0)
        for name, claim in found.items()
    }
    lines = [line for line in readme_table(results).splitlines() if "left out of this run" not in line]
    assert len(lines) == 2 + len(QUESTIONS) - 3  # cost, exactness and random scenes
    assert set(lines) <= set(shown)


@pytest.mark.slow
def test_the_printed_numbers_of_the_readme_are_the_computed_ones():
    table = printed_numbers.printed_table({name: evaluate(name) for name in printed_numbers.CLAIMS})
    begin, end = printed_numbers.MARKS
    assert f"{begin}\n{table}\n{end}" in README.read_text("utf-8")


def test_a_claim_that_raises_is_a_failed_check(monkeypatch):
    from validation.paper import bounds

    monkeypatch.setattr(bounds, "claim", lambda: 1 / 0)
    (check,) = evaluate.__wrapped__("bounds").checks
    assert not check.passed
    assert "ZeroDivisionError" in check.name


def test_each_claim_is_in_one_chapter():
    assert sorted(name for chapter in CHAPTERS for name in chapter.claims) == sorted([*claims(), *costs()])
