"""Every claim of the validation holds."""

import pytest

from validation.__main__ import claims, evaluate


@pytest.mark.parametrize("name", claims())
def test_claim_holds(name):
    failed = [check for check in evaluate(name).checks if not check.passed]
    assert not failed
