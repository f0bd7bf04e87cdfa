"""Numbers of the report: digits, signs and powers of ten."""

import pytest

from validation.check import Check, above, below, near
from validation.numbers import computed, expected, is_identity, number, powers, share
from validation.sources import known_input

HERE = known_input("a test")


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.0, "0"),
        (64.0, "64"),
        (123456789.0, "123,456,789"),
        (12345.678, "12,350"),
        (0.018852975, "0.01885"),
        (-0.0351, "−0.0351"),
        (3.2e-13, "3.2 × 10⁻¹³"),
        (9.96e-6, "1.0 × 10⁻⁵"),
        (2.04e22, "2.0 × 10²²"),
        (float("inf"), "none"),
    ],
)
def test_numbers_have_the_digits_that_mean_something(value, text):
    assert number(value) == text


def test_powers_of_ten_are_written_out():
    assert powers("9.4 ± 1e-06, at most 2.5e+12") == "9.4 ± 10⁻⁶, at most 2.5 × 10¹²"


@pytest.mark.parametrize(
    ("check", "words"),
    [
        (near("a", 9.41458836, 9.41459, 1e-6, HERE), "9.41459 | 9.41459 ± 10⁻⁶"),
        (near("a", 6.9036851, 6.73, 0.22, HERE), "6.9 | 6.73 ± 0.22"),
        (near("a", 240.8179, 243.6, 20.0, HERE), "241 | 243.6 ± 20"),
        (near("a", 5.0, 5.0, 0.0, HERE), "5 | 5"),
        (near("a", -2.8e-14, 0.0, 1e-6, HERE), "−2.8 × 10⁻¹⁴ | 0 ± 10⁻⁶"),
        (
            Check("a", 0.020278812, "0.0202788 ± 1e-08 relative", True, HERE),
            "0.0202788 | 0.0202788 ± 10⁻⁸ relative",
        ),
        (Check("a", 1.0034567, "1.01235 ± 0.02 relative", True, HERE), "1.003 | 1.012 ± 0.02 relative"),
        (below("a", 1.6e-15, 1e-9, HERE), "1.6 × 10⁻¹⁵ | at most 10⁻⁹"),
        (below("a", 0.0188529, 0.2, HERE), "0.0189 | at most 0.2"),
    ],
)
def test_a_computed_number_has_the_digits_of_its_tolerance(check, words):
    assert f"{computed(check)} | {expected(check)}" == words


@pytest.mark.parametrize(
    ("check", "used", "identity"),
    [
        (near("slope", 6.9, 6.87, 0.05, HERE), 0.6, False),
        (near("count", 64.0, 64.0, 0.0, HERE), 0.0, False),
        (near("scale", 2.0, 2.0, 1e-10, HERE), 0.0, True),
        (below("error", 0.3, 0.4, HERE), 0.75, False),
        (below("residual", 1e-15, 1e-12, HERE), 0.001, True),
        (above("gain", 4.0, 3.0, HERE), 0.75, False),
        (Check("refused", 3.0, "all", True, HERE), 0.0, False),
    ],
)
def test_the_used_share_of_a_limit_and_identities(check, used, identity):
    assert share(check) == pytest.approx(used)
    assert is_identity(check) == identity
