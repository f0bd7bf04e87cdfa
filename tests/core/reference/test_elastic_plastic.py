"""The published formulas of elastic-plastic contacts: limits, and the jumps that they have."""

import pytest

from metafem.reference import jackson_green, kogut_etsion


def test_below_yield_the_contact_is_hertz():
    for law in [lambda w: kogut_etsion(w, 0.3), lambda w: jackson_green(w, 0.3, 2e-3)]:
        assert law(0.5) == pytest.approx((0.5**1.5, 0.5), rel=1e-15)


def test_fully_plastic_pressure_is_the_hardness():
    """P/A = H means P/P_c over A/A_c = H A_c/P_c = 3/(2 K)."""
    load, area = kogut_etsion(200.0, 0.3)
    assert load / area == pytest.approx(1.5 / (0.454 + 0.41 * 0.3), rel=1e-14)


def test_pressure_of_a_deep_contact_tends_to_the_hardness_of_jackson_and_green():
    """At w* = 1e6 and vanishing S_y/E* the load is 4 H/(C S_y) w* with H = 2.84 S_y."""
    factor = 1.295 * 2.718281828459045 ** (0.736 * 0.3)
    load, area = jackson_green(1e6, 0.3, 1e-9)
    mean = load / area * (1e6 / 1.9) ** 0.14  # the formula multiplies H by w*, not by A/A_c
    assert mean == pytest.approx(4.0 * 2.84 / factor, rel=1e-6)
