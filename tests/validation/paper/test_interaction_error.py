"""The answer on interaction reads the rms by each norm of the claim."""

from validation.paper.interaction_error import READINGS
from validation.verdicts import NORMS


def test_each_reading_of_the_rms_is_in_the_answer():
    assert {row for _, row in NORMS} == {"rms", *(reading.words for reading in READINGS)}
