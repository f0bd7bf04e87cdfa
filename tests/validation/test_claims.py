"""Each claim of the validation holds, and each check names a source."""

import re
from pathlib import Path

import pytest

from validation.__main__ import claims, is_slow
from validation.chapters import CHAPTERS
from validation.results import costs, evaluate
from validation.sources import Source

# Long studies of which the README shows no number: `python -m validation NAME` evaluates them.
# The tests of these folders compare what they call with the same sources, in smaller scenes.
STUDIES = {
    "diagnosis": "tests/calibration/diagnosis",
    "fe_finite_strain": "tests/fe/large_strain",
    "layout": "tests/inversion/placement",
    "topography": "tests/calibration/topography",
}

# The claims that the tests evaluate.
EVALUATED = [name for name in claims() if name not in STUDIES]

# Quick claims whose pictures still take seconds.
LONG = ("any_law", "fig_s3_manufacturing")

# The longest of the slow ones come first, so that the processes end together.
FIRST = ("block_or_layer", "several_radii", "order3_against_resolved", "fe_hertz", "calibration_bias")

NAMES = [
    pytest.param(name, marks=pytest.mark.slow) if is_slow(name) or name in LONG else name
    for name in (*FIRST, *(name for name in EVALUATED if name not in FIRST))
]

# Words that name no source.
VAGUE = re.compile(
    r"promise|recomputed|independent(ly)? comput|another (code|implementation)|^solved|^exact$|^target$", re.I
)


@pytest.mark.parametrize("claim", NAMES, indirect=True)
def test_claim_holds_and_each_check_names_its_source(claim):
    assert not [check for check in claim.checks if not check.passed]
    for check in claim.checks:
        assert isinstance(check.source, Source), check
        assert str(check.source).strip(), check.name
        assert not VAGUE.search(str(check.source)), check


@pytest.mark.parametrize("claim", NAMES, indirect=True)
def test_each_figure_has_a_caption_and_each_claim_a_text(claim):
    assert claim.text.count(".") >= 2
    for title, caption in claim.figures.items():
        assert len(caption.split()) > 10, title
        assert caption.endswith("."), title


def test_a_claim_that_raises_is_a_failed_check(monkeypatch):
    from validation.paper import bounds

    monkeypatch.setattr(bounds, "claim", lambda: 1 / 0)
    (check,) = evaluate.__wrapped__("bounds").checks
    assert not check.passed
    assert "ZeroDivisionError" in check.name


def test_studies_are_claims_of_the_report_whose_parts_have_tests():
    assert set(STUDIES) < set(claims())
    for folder in STUDIES.values():
        assert list((Path(__file__).parents[2] / folder).glob("test_*.py")), folder


def test_each_claim_is_in_one_chapter():
    assert sorted(name for chapter in CHAPTERS for name in chapter.claims) == sorted([*claims(), *costs()])
