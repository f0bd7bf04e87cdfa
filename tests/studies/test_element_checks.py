"""Checks of the finite elements: that they fail where an expectation is wrong, and the orders they fit."""

import pytest

from metafem.studies import element_checks


@pytest.mark.slow
def test_a_wrong_expectation_fails(monkeypatch):
    monkeypatch.setattr(element_checks, "CAP_ROWS", ((0.12, 0.10),))
    right = element_checks.search_contact

    def wrong(indentation, *args, **kwargs):
        return right(1.05 * indentation, *args, **kwargs)

    monkeypatch.setattr(element_checks, "search_contact", wrong)
    load, *others = element_checks.cap_check()
    assert not load.passed
    assert all(check.passed for check in others)


@pytest.mark.slow
def test_the_layer_is_checked_in_units_of_the_half_space(monkeypatch):
    monkeypatch.setattr(element_checks.bonded_layer, "regular_influence", lambda *_: 0.0)
    assert not any(check.passed for check in element_checks.layer_check())


def test_errors_of_the_load_fall_by_digits_with_the_degree():
    study = element_checks.spectral_convergence(0.3)
    assert study.rate < -0.5
