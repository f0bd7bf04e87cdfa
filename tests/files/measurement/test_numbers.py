"""Values with as many digits as their errors allow."""

import pytest

from metafem.files.measurement.numbers import interval, published, rounded


@pytest.mark.parametrize(
    ("value", "sd", "text"),
    [
        (1.35987, 0.0393, "1.36 ± 0.04"),
        (0.4040, 0.0054, "0.404 ± 0.005"),
        (0.8512, 0.0121, "0.851 ± 0.012"),
        (0.8512, 0.00996, "0.851 ± 0.010"),
        (523.4, 47.1, "523 ± 47"),
        (0.85, 0.0, "0.85 ± 0"),
    ],
)
def test_errors_are_published_with_one_or_two_digits(value, sd, text):
    assert published(value, sd) == text


def test_values_and_intervals_have_the_digits_of_the_error():
    assert rounded(1.35987, 0.0393, 3) == "1.3599"
    assert interval((0.36, 0.39), 0.0148, "MPa") == "0.360 to 0.390 MPa"
