"""Odds in sentences."""

import pytest

from metafem.calibration.diagnosis.sentences import models


@pytest.mark.parametrize(("ratio", "odds"), [(0.4, "1.5"), (9.0, "8,100"), (6894.0, "more than 10^6")])
def test_odds_are_written_out_up_to_a_million(ratio, odds):
    (sentence,) = models({"JKR": 0.0, "Hertz": -ratio})
    assert f"({odds} to 1)" in sentence
