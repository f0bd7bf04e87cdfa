"""The answer on interaction reads the rms by each norm of the claim."""

import pytest

from validation.check import Check, Difference
from validation.paper.interaction_error import READINGS
from validation.verdicts import QUESTIONS


def test_each_reading_of_the_rms_is_in_the_answer():
    read = {names[0] for _, _, *names in QUESTIONS["interaction"]["numbers"].values()}
    for words in ("rms", *READINGS):
        assert f"Fig. 3: median {words} of random assignments" in read


@pytest.mark.slow
def test_both_statistics_of_each_surface_are_judged_or_are_a_difference(evaluated):
    claim = evaluated("interaction_error")
    judged = {row.name for row in claim.rows if isinstance(row, Check)}
    (largest,) = (
        row for row in claim.rows if isinstance(row, Difference) and row.name.startswith("all surfaces")
    )
    for surface in ("Fig. 4 blue", "Fig. 4 red", "Fig. 5 blue", "Fig. 5 red"):
        assert f"{surface}: median rms of random assignments" in judged
        below = claim.value(f"{surface}: largest rms of random assignments") < 0.023
        assert below == (f"{surface}: largest rms of random assignments" in judged)
        assert below == (surface not in largest.words.split(";")[0])
    assert "6.3 % (Fig. 4 red)" in largest.words
    assert "5.2 % (Fig. 5 blue)" in largest.words
