import numpy as np
import pytest


@pytest.fixture
def grey():
    """Return five pictures of random grey levels, 64 x 80 pixels of 8 bits."""
    return np.random.default_rng(0).integers(0, 256, (5, 64, 80), dtype=np.uint8)
