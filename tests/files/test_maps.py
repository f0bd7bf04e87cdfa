"""Height maps of several formats are read to the same heights, with their units."""

import warnings

import numpy as np
import pytest

import metafem as mf
from metafem.files.images import read_height_map

# Heights [um] of 6 rows and 5 columns with two holes; relative to their median 14.5.
HEIGHTS = np.arange(30.0).reshape(6, 5)
HEIGHTS[0, 1] = HEIGHTS[4, 3] = np.nan
MIDDLE = float(np.nanmedian(HEIGHTS))


@pytest.fixture(scope="module")
def topography():
    """The map as SurfaceTopography stores it: x along the first axis, y upwards."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Could not import mpi4py", ImportWarning)
        from SurfaceTopography import Topography
    upwards = HEIGHTS[::-1].T
    return Topography(np.ma.masked_invalid(upwards), (10.0, 18.0), unit="µm")  # pixels of 2 x 3 um


def test_a_map_in_x3p(topography, tmp_path):
    topography.to_x3p(str(tmp_path / "map.x3p"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # an importer without mpi warns nobody
        heights, sides = read_height_map(tmp_path / "map.x3p")
    assert sides == pytest.approx((2e-3, 3e-3), rel=1e-12)
    np.testing.assert_allclose(heights, 1e-3 * (HEIGHTS - MIDDLE), atol=1e-9)  # single precision of 15 um
    other, sides = read_height_map(tmp_path / "map.x3p", 4e-3, "mm")  # what the user says counts
    assert sides == (4e-3, 4e-3)
    np.testing.assert_allclose(other, 1e-3 * heights, rtol=1e-5)  # the file says metres


@pytest.mark.parametrize("name", ["map.sur", "map.x3p"])
def test_a_damaged_map_is_named(tmp_path, name):
    (tmp_path / name).write_text("DIGITAL SURF and then nothing")
    with pytest.raises(mf.InvalidInput, match=f"{name} cannot be read as a height map"):
        read_height_map(tmp_path / name)
