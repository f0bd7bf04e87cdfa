"""Surfaces that several studies share."""

import numpy as np
import pytest

import metafem as mf
from tests.conftest import MATERIAL, RADIUS


@pytest.fixture(scope="session")
def surface():
    """16 asperities with exponentially distributed heights."""
    height = 0.1 + np.random.default_rng(3).exponential(0.02, 16)
    friction, block = mf.Friction(0.404, 0.85), mf.Block(10.0, 10.0, 7.2)
    return mf.Surface.square_lattice(
        height, (4, 4), radius=0.526, material=mf.Material(1.36), friction=friction, block=block
    )


@pytest.fixture(scope="session")
def linear():
    """The heights of an exponential law on the paper's lattice."""
    height = 0.2 - 0.02 * np.log(64 / (np.arange(64) + 0.5))
    return mf.Surface.square_lattice(
        height, radius=RADIUS, material=MATERIAL, block=mf.Block(20.0, 20.0, 7.2)
    )


@pytest.fixture(scope="session")
def design():
    """A design of six asperities through two points."""
    material, block = mf.Material(1.36), mf.Block(20.0, 20.0, 7.2)
    template = mf.Surface.square_lattice(0.12, (2, 3), radius=0.526, material=material, block=block)
    return mf.design(mf.OperatingPoints([0.01, 0.03], [0.1, 0.26]), template)
