"""The active set that checks the finite elements, against Hertz and the conditions of contact."""

import numpy as np
import pytest

from metafem.fe.geometry import Cap
from validation.finite_elements.active_set import _active_set, search_contact


def test_the_active_set_finds_hertz_on_a_coarse_mesh_and_in_other_units():
    contact = search_contact(1e6, 1e6, 0.3, cell=1e6 / 10.3)
    # Second order from 1e-4 at forty cells: sixteen times that at ten.
    assert contact.rescaled_load == pytest.approx(4.0 / 3.0 * 1e12, rel=1.6e-3)
    assert contact.contact_radius == pytest.approx(1e6, rel=1.6e-3)
    assert contact.last_radius == pytest.approx(1e6, rel=0.1)


def test_active_set_solves_the_complementarity():
    rng = np.random.default_rng(0)
    root = rng.normal(size=(30, 30))
    flexibility = root @ root.T + 30.0 * np.eye(30)
    wanted = rng.normal(size=30)
    force = _active_set(flexibility, wanted)
    gap = flexibility @ force - wanted
    assert force.min() >= 0.0
    assert gap.min() > -1e-12
    assert np.abs(force * gap).max() < 1e-12


def test_low_cap_on_a_wide_block_is_hertz():
    """A contact that is small against the cap and the block; the base is 100 contact radii away."""
    contact = search_contact(1e-4, 1.0, cell=1e-2 / 10.3, cap=Cap(1.0, 0.05, 2.0, 1.0))
    # 1e-3 of the coarse mesh, and the layer's self term -1.77 P/(pi t), 0.8 % of the indentation's load
    assert contact.rescaled_load == pytest.approx(4.0 / 3.0 * 1e-6, rel=0.03)
    assert contact.last_radius == pytest.approx(1e-2, rel=0.1)
