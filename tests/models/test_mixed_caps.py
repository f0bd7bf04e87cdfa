"""Caps that differ from asperity to asperity, resolved."""

import numpy as np

import metafem as mf
from tests.core.models.test_mixed_caps import CAPS


def test_order_3_agrees_with_resolved_contacts():
    rng = np.random.default_rng(1)
    cap = [CAPS[i % 4] for i in range(9)]
    part = mf.Surface.square_lattice(
        0.1 - 0.01 * rng.random(9), (3, 3), 1.2, radius=0.526, material=mf.Material(1.0), cap=cap
    )
    coarse, fine = (
        mf.friction_law(part, mf.BoundaryElements(cell, contact=mf.Elastic()), load=[0.05, 0.1])
        for cell in (0.01, 0.005)
    )
    law = mf.friction_law(part, mf.Interacting(contact=mf.Elastic()), load=[0.05, 0.1])
    area = fine.area + (fine.area - coarse.area) / 3.0
    np.testing.assert_allclose(law.area, area, rtol=2e-3)
