"""Independent asperities and their equilibrium."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import metafem as mf

MATERIAL = mf.Material(1.36)


def test_one_asperity_obeys_hertz(template):
    surface = template.replaced(position=[[0.0, 0.0]], height=[0.1], radius=[0.526])
    state = mf.equilibrium(surface, load=0.05)
    a = (0.75 * 0.05 * 0.526 / 1.36) ** (1.0 / 3.0)
    assert state.area == pytest.approx(math.pi * a * a, rel=1e-12)
    assert state.approach == pytest.approx(a * a / 0.526, rel=1e-12)
    assert state.separation == pytest.approx(0.1 - a * a / 0.526, rel=1e-12)
    assert state.stiffness == pytest.approx(2.0 * 1.36 * a, rel=1e-12)


def test_load_equation_holds_from_light_to_heavy_loads(rough):
    full = mf.equilibrium(rough, separation=float(rough.height.min())).load
    for load in full * np.geomspace(1e-12, 10.0, 23):
        state = mf.equilibrium(rough, load=load)
        assert state.residual <= 1e-12
        # the load follows from what the state holds, though the separation has lost the digits
        indentation = np.maximum(state.approach - rough.gap, 0.0)
        again = 4 / 3 * 1.36 * math.sqrt(0.526) * math.fsum(indentation**1.5)
        assert again == pytest.approx(load, rel=1e-9)
        assert math.fsum(state.asperity_load) == pytest.approx(load, rel=1e-12)


@settings(max_examples=10)
@given(st.integers(0, 10**6), st.floats(0.01, 3.0))
def test_many_surfaces_at_once_agree_with_one_by_one(seed, load):
    rng = np.random.default_rng(seed)
    height, radius = rng.exponential(0.03, (3, 6)), rng.uniform(0.3, 3.0, 6)
    surface = mf.Surface(rng.random((6, 2)), height[0], radius, MATERIAL)
    area = mf.Independent().areas(surface, np.array([load, 2.0 * load]), height)
    for row, a in zip(height, area[:, 0], strict=True):
        assert mf.equilibrium(surface.replaced(height=row), load=1.36 * load).area == pytest.approx(
            a, rel=1e-11
        )


def test_shallow_contacts_on_deep_gaps_keep_their_digits():
    height = np.full(100_000, 0.1)
    height[0] = 0.101
    surface = mf.Surface.square_lattice(height, (1, 100_000), radius=0.5, material=MATERIAL)
    for load in (1e-3, 0.1):
        assert mf.equilibrium(surface, load=load).residual <= 1e-14
        assert mf.friction_law(surface, load=[load]).residual[0] <= 1e-14
