"""Every claim of the validation holds."""

import importlib

import pytest

from validation.__main__ import claims, evaluate


def marks(name):
    """A claim that takes long says so itself."""
    return [pytest.mark.slow] if getattr(importlib.import_module(f"validation.{name}"), "SLOW", False) else []


@pytest.mark.parametrize("name", [pytest.param(name, marks=marks(name)) for name in claims()])
def test_claim_holds(name):
    failed = [check for check in evaluate(name).checks if not check.passed]
    assert not failed
