"""Tangential stiffness against the onset of sliding and Mindlin's ratio."""

import numpy as np
import pytest

import metafem as mf

HEIGHT = 0.1 + 0.03 * np.random.default_rng(0).random(9)


def test_independent_contacts_have_mindlins_ratio():
    """Tangential over normal stiffness is 2 (1 - nu)/(2 - nu)."""
    for ratio in [0.0, 0.3]:
        material = mf.Material(1.36, ratio)
        surface = mf.Surface.square_lattice(HEIGHT, (3, 3), 1.5, radius=0.526, material=material)
        found = mf.tangential_stiffness(surface, load=[0.1, 0.3])
        expected = 2.0 * (1.0 - ratio) / (2.0 - ratio) * mf.friction_law(surface, load=[0.1, 0.3]).stiffness
        assert found == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("model", [mf.Interacting(), mf.BoundaryElements(0.02)])
def test_it_is_the_first_stiffness_of_the_onset(model):
    given = {"radius": 0.526, "material": mf.Material(1.36), "friction": mf.Friction(0.4)}
    surface = mf.Surface.square_lattice(HEIGHT, (3, 3), 1.5, **given)
    found = mf.tangential_stiffness(surface, model, load=[0.2])[0]
    assert found == pytest.approx(mf.onset(surface, model, load=0.2).stiffness, rel=1e-12)
