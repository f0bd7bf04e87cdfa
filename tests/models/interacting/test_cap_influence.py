"""The pedestal's place on the diagonal: the table's limit of light loads."""

import numpy as np

import metafem as mf
from metafem.contact import pedestal_compliance
from metafem.models.interacting.cap_influence import pedestal_influence

HEIGHT, RADIUS = np.array([0.03, 0.12, 0.30]), np.array([0.526, 0.526, 0.6])


def test_it_is_the_fit_without_a_contact():
    value, _ = pedestal_influence(HEIGHT, RADIUS)
    np.testing.assert_allclose(np.pi * value, pedestal_compliance(HEIGHT, RADIUS), rtol=1e-14)


def test_its_rate_is_its_derivative():
    step = 1e-6  # central differences: error step^2
    ahead, behind = (pedestal_influence(HEIGHT + s * step, RADIUS)[0] for s in (1, -1))
    np.testing.assert_allclose(
        pedestal_influence(HEIGHT, RADIUS)[1], (ahead - behind) / (2 * step), rtol=1e-8
    )


def test_summits_at_the_base_plane_have_none():
    value, rate = pedestal_influence(np.array([-0.1, 0.0]), np.ones(2))
    assert not value.any()
    assert not rate.any()


def test_summits_beyond_the_table_keep_its_last_row_and_say_so():
    value, rate = pedestal_influence(np.array([0.6, 0.9]), np.ones(2))
    assert value[0] == value[1]
    assert rate[1] == 0.0
    surface = mf.Surface([[0.0, 0.0]], [0.4], 0.526, mf.Material(1.36))
    state = mf.equilibrium(surface, mf.Interacting(pedestal=True), load=0.02)
    assert "higher than 0.6 R" in state.notes[0].text
