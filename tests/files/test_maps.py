"""A height map that SurfaceTopography reads gives the made surface, as the guide says."""

import warnings

import numpy as np
import pytest

from metafem.calibration import made_surface
from tests.calibration.topography.scenes import FOUR, PIXEL, mapped


def test_a_map_in_x3p_gives_the_heights(tmp_path):
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Could not import mpi4py", ImportWarning)
        from SurfaceTopography import Topography, read_topography
    heights = 1e3 * mapped().astype(float)
    heights[::7, ::5] = np.nan  # not measured
    upwards = np.ma.masked_invalid(heights[::-1].T)
    Topography(upwards, (800e3 * PIXEL, 800e3 * PIXEL), unit="µm").to_x3p(str(tmp_path / "part.x3p"))
    part = read_topography(tmp_path / "part.x3p").to_unit("mm")
    made = made_surface(part.heights().T[::-1], part.pixel_size, FOUR)
    assert part.pixel_size == pytest.approx((PIXEL, PIXEL), rel=1e-9)
    assert np.abs(made.height_error).max() < 1e-3
