"""Checks of the finite elements: that they fail where an expectation is wrong, and the orders they fit."""

from metafem.studies import element_checks


def test_the_layer_is_checked_in_units_of_the_half_space(monkeypatch):
    monkeypatch.setattr(element_checks.bonded_layer, "regular_influence", lambda *_: 0.0)
    assert not any(check.passed for check in element_checks.layer_check())
