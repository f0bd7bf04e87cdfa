"""Surfaces scaled to a pull-off force."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import metafem as mf

LAW = mf.JKR(9e-6)
SINGLE = 1.5 * np.pi * 9e-6 * 0.526


@pytest.mark.parametrize(("model", "share"), [(mf.Independent(LAW), 0.8), (mf.Interacting(contact=LAW), 0.3)])
def test_the_surface_has_the_force(model, share):
    height, force = 0.1 - 0.01 * np.random.default_rng(0).random(4), share * 4 * SINGLE
    surface = mf.Surface.square_lattice(height, (2, 2), 1.5, radius=0.526, material=mf.Material(1.36))
    found = mf.scaled_to_pull_off(surface, force, model, load=0.05)
    assert mf.pull_off(found, model, load=0.05) == pytest.approx(force, rel=1e-6)
    factor = found.gap[1:] / np.where(surface.gap[1:] > 0.0, surface.gap[1:], 1.0)
    assert_allclose(factor[surface.gap[1:] > 0.0], factor[surface.gap[1:] > 0.0][0], rtol=1e-9)


def test_two_contacts_against_the_sum_of_their_curves():
    """Force of two JKR contacts at one separation, by a scan over the contact radius of the taller one."""
    surface = mf.Surface([[0, 0], [2, 0]], [0.1, 0.0995], 0.526, mf.Material(1.36))
    model = mf.Independent(LAW)
    found = mf.scaled_to_pull_off(surface, 1.7 * SINGLE, model, load=0.01)
    law, gap = LAW.for_material(surface.material), found.gap.max()
    a = np.linspace(0.004, 0.1, 200_001)
    d, p = law.indentation(a, 0.526), law.load(a, 0.526)
    rising = slice(int(d.argmin()), None)  # the stable branch
    both = p[rising] + np.interp(d[rising] - gap, d[rising], p[rising], left=0.0)
    assert -1.36 * both.min() == pytest.approx(1.7 * SINGLE, rel=1e-6)
