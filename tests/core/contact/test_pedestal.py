"""The fit of the pedestal's compliance against its table."""

import numpy as np
import pytest

import metafem as mf
from metafem.contact import pedestal
from validation.scenes import pedestals


def test_the_fit_keeps_its_error_on_the_whole_table():
    for ratio, *row in pedestals.TABLE:
        foot = np.sqrt(ratio * (2.0 - ratio))
        fitted = pedestal.pedestal_compliance(ratio, 1.0, foot * np.array(pedestals.FOOT_RATIOS))
        np.testing.assert_allclose(fitted, row, rtol=pedestal.FIT_ERROR)


def test_other_computations_agree():
    """c_p [1/mm] at R = 0.526 mm, printed to two decimals, at contacts of about a tenth of R.

    With the contact the compliance changes by a few hundredths.
    """
    found = pedestal.pedestal_compliance(np.array([0.12, 0.20, 0.27]), 0.526, 0.05)
    np.testing.assert_allclose(found, [0.27, 0.46, 0.64], atol=0.02)


def test_lengths_scale():
    assert pedestal.pedestal_compliance(0.2, 0.5, 0.1) == pytest.approx(
        10.0 * pedestal.pedestal_compliance(2.0, 5.0, 1.0), rel=1e-12
    )


HEIGHT, RADIUS = np.array([0.03, 0.12, 0.30]), np.array([0.526, 0.526, 0.6])


def test_the_influence_of_a_pedestal_is_the_fit_without_a_contact():
    value, _ = pedestal.pedestal_influence(HEIGHT, RADIUS)
    np.testing.assert_allclose(np.pi * value, pedestal.pedestal_compliance(HEIGHT, RADIUS), rtol=1e-14)


def test_its_rate_is_its_derivative():
    step = 1e-6  # central differences: error step^2
    ahead, behind = (pedestal.pedestal_influence(HEIGHT + s * step, RADIUS)[0] for s in (1, -1))
    np.testing.assert_allclose(
        pedestal.pedestal_influence(HEIGHT, RADIUS)[1], (ahead - behind) / (2 * step), rtol=1e-8
    )


def test_summits_at_the_base_plane_have_none():
    value, rate = pedestal.pedestal_influence(np.array([-0.1, 0.0]), np.ones(2))
    assert not value.any()
    assert not rate.any()


def test_summits_beyond_the_table_keep_its_last_row_and_say_so():
    value, rate = pedestal.pedestal_influence(np.array([0.6, 0.9]), np.ones(2))
    assert value[0] == value[1]
    assert rate[1] == 0.0
    surface = mf.Surface([[0.0, 0.0]], [0.4], 0.526, mf.Material(1.36))
    state = mf.equilibrium(surface, mf.Interacting(pedestal=True), load=0.02)
    assert "higher than 0.6 R" in state.notes[0].text
