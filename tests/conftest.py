"""Settings and scenes that all tests share."""

import numpy as np
import pytest
from hypothesis import settings

import metafem as mf

# Property tests draw the same cases on every run and are never timed.
settings.register_profile("metafem", deadline=None, derandomize=True, max_examples=40)
settings.load_profile("metafem")

MATERIAL = mf.Material(composite_modulus=1.36, poisson_ratio=0.5)
RADIUS = 0.526


@pytest.fixture
def template():
    """The paper's lattice with a material pair and a block."""
    return mf.Surface.square_lattice(
        0.12,
        radius=RADIUS,
        material=MATERIAL,
        friction=mf.Friction(0.358, 0.85),
        block=mf.Block(20.0, 20.0, 7.2),
    )


@pytest.fixture
def rough(template):
    """The same lattice with exponential heights."""
    return template.replaced(height=np.random.default_rng(1).exponential(0.03, template.count) + 0.05)
