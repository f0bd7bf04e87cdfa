"""Height maps of several formats are read to the same heights, with their units."""

import struct
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
    for option in ({"pixel": "2 um"}, {"height_unit": "um"}):
        with pytest.raises(mf.InvalidInput, match="leave --"):
            read_height_map(tmp_path / "map.x3p", **option)


def sur_file(path):
    """Write the map in the format of Digital Surf: 32-bit integers of 1 nm, holes by the mark zmin - 2."""
    raw = np.nan_to_num(1000.0 * HEIGHTS[::-1], nan=-2.0).astype("<i4")
    texts = (text.encode("latin-1").ljust(16) for text in ("X", "Y", "Z", "mm", "mm", "µm", "mm", "mm", "µm"))
    header = struct.pack(
        "<12s4H30s30s5H8xHiiiiIfff144s3f3H12x7Hf10xHH128s3f34x",
        b"DIGITAL SURF", 0, 1, 1, 2, b"map".ljust(30), b"".ljust(30), 0, 0, 0, 1, 1, 32, 0, 29000, 5, 6, 30,
        2e-3, 3e-3, 1e-3, b"".join(texts), 1.0, 1.0, 1.0, 0, 0, 0, 0, 0, 0, 1, 1, 2026, 0, 0.0, 0, 0, b"",
        0.0, 0.0, 0.0,
    )  # fmt: skip
    path.write_bytes(header + raw.tobytes())


def test_a_map_of_digital_surf(tmp_path):
    sur_file(tmp_path / "map.sur")
    heights, sides = read_height_map(tmp_path / "map.sur")
    # a header in single precision
    assert sides == pytest.approx((2e-3, 3e-3), rel=1e-6)
    np.testing.assert_allclose(heights, 1e-3 * (HEIGHTS - MIDDLE), atol=1e-8)


@pytest.mark.parametrize("name", ["map.sur", "map.x3p"])
def test_a_damaged_map_is_named(tmp_path, name):
    (tmp_path / name).write_text("DIGITAL SURF and then nothing")
    with pytest.raises(mf.InvalidInput, match=f"{name} cannot be read as a height map"):
        read_height_map(tmp_path / name)
