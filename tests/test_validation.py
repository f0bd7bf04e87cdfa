"""Every claim of the validation holds."""

import pytest

from validation.__main__ import claims, evaluate, is_slow


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if is_slow(name) else name for name in claims()]
)
def test_claim_holds(name):
    failed = [check for check in evaluate(name).checks if not check.passed]
    assert not failed
