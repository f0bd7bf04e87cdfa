"""How a misfit is printed."""

import pytest

from metafem.inversion.assessment import misfit_text


@pytest.mark.parametrize(
    ("misfit", "text"),
    [
        (0.0, "below 1e-9"),
        (0.0049, "0.49 %"),
        (0.01, "1 %"),
        (0.01003, "1.003 %"),
        (0.1004, "10.04 %"),
        (0.0999, "10 %"),
        (3.3, "330 %"),
        (float("nan"), "nan %"),
    ],
)
def test_a_misfit_above_a_limit_is_not_printed_as_the_limit(misfit, text):
    assert misfit_text(misfit) == text
