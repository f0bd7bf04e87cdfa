"""Each claim of the validation holds, and each check names a source."""

import re
from pathlib import Path

import pytest

from validation.__main__ import MARKS, claims, evaluate, is_slow
from validation.chapters import CHAPTERS
from validation.page import readme_table

NAMES = [pytest.param(name, marks=pytest.mark.slow) if is_slow(name) else name for name in claims()]

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
        assert str(check.source).strip(), check.name
        assert not VAGUE.search(str(check.source)), check


@pytest.mark.slow
def test_the_table_of_the_readme_is_the_one_that_is_computed():
    readme = (Path(__file__).parents[2] / "README.md").read_text("utf-8")
    results = {name: evaluate(name) for name in claims()}
    assert f"{MARKS[0]}\n{readme_table(results)}\n{MARKS[1]}" in readme


def test_a_claim_that_raises_is_a_failed_check(monkeypatch):
    from validation.paper import bounds

    monkeypatch.setattr(bounds, "claim", lambda: 1 / 0)
    (check,) = evaluate.__wrapped__("bounds").checks
    assert not check.passed
    assert "ZeroDivisionError" in check.name


def test_each_claim_is_in_one_chapter():
    assert sorted(name for chapter in CHAPTERS for name in chapter.claims) == sorted(claims())
