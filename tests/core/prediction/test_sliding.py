"""The onset of sliding against its closed forms, and against Mindlin's contact by its own constants."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import metafem as mf

FRICTION = mf.Friction(0.404, 0.85)


def rough(ratio=0.5, seed=0, side=5):
    height = 0.1 + 0.03 * np.random.default_rng(seed).random(side**2)
    material = mf.Material(1.36, ratio)
    return mf.Surface.square_lattice(
        height, (side, side), 1.5, radius=0.526, material=material, friction=FRICTION
    )


def test_one_contact_is_mindlins():
    """8 a G/(2 - nu) with G = E/(2 (1 + nu)): 2/3 of the normal stiffness for nu = 1/2, equal to it for 0."""
    for ratio in [0.0, 0.3, 0.5]:
        surface = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material.from_young(1.0, ratio), FRICTION)
        found = mf.onset(surface, load=0.01)
        radius = np.sqrt(found.state.area / np.pi)
        shear_modulus = 1.0 / (2.0 * (1.0 + ratio))
        assert found.stiffness == pytest.approx(8.0 * radius * shear_modulus / (2.0 - ratio), rel=1e-12)
        expected = 2.0 * (1.0 - ratio) / (2.0 - ratio) * found.state.stiffness
        assert found.stiffness == pytest.approx(expected, rel=1e-12)
        assert found.displacement[-1] * found.stiffness == pytest.approx(found.friction_force[0], rel=1e-12)


@given(st.integers(0, 1000), st.floats(0.01, 0.5), st.floats(0.0, 0.5))
def test_force_is_the_sum_over_sticking_and_sliding_contacts(seed, load, ratio):
    surface = rough(ratio, seed)
    found = mf.onset(surface, load=load)
    area = found.state.asperity_area
    stiffness = 8.0 * 1.36 * (1.0 - ratio) / (2.0 * (2.0 - ratio)) * np.sqrt(area / np.pi)
    each = np.minimum(stiffness * found.displacement[:, None], 0.404 * 0.85 * area)
    assert found.friction_force == pytest.approx(each.sum(axis=1), rel=1e-12)
    assert (np.diff(found.displacement) >= 0.0).all()
    law = mf.friction_law(surface, load=[load])
    assert found.friction_force[-1] == pytest.approx(law.friction_force[0], rel=1e-12)


def test_every_model_predicts_an_onset():
    surface = rough(side=2)
    models = (mf.Independent(), mf.Interacting(), mf.BoundaryElements(0.01), mf.Independent(mf.JKR(9e-6)))
    ends = [mf.onset(surface, model, load=0.05).displacement[-1] for model in models]
    assert ends == pytest.approx([ends[0]] * len(ends), rel=0.1)


def test_picture_has_a_mark_for_each_contact():
    found = mf.onset(rough(), load=0.3)
    line, marks = found.plot().get_lines()
    assert len(marks.get_xdata()) == len(found.displacement)
    assert line.get_ydata()[-1] == found.friction_force[-1]
