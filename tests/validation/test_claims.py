"""Each claim of the validation holds, and each check names a source."""

import re

import pytest

from validation.__main__ import claims, is_slow
from validation.chapters import CHAPTERS
from validation.results import costs, evaluate
from validation.sources import Source

# Quick claims whose pictures still take seconds.
LONG = ("any_law", "fig_s3_manufacturing")

# The longest of the slow ones come first, so that the processes end together.
FIRST = ("fe_finite_strain", "block_or_layer", "order3_against_resolved", "layout", "fe_hertz", "topography")

NAMES = [
    pytest.param(name, marks=pytest.mark.slow) if is_slow(name) or name in LONG else name
    for name in (*FIRST, *(name for name in claims() if name not in FIRST))
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


def test_each_claim_is_in_one_chapter():
    assert sorted(name for chapter in CHAPTERS for name in chapter.claims) == sorted([*claims(), *costs()])
