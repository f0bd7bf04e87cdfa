"""Height maps of several formats are read to the same heights, with their units."""

import struct
import warnings
import zipfile

import numpy as np
import pytest

import metafem as mf
from metafem.files.measurement.maps import read_height_map

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


def check(stored, pixel=(2e-3, 3e-3)):
    assert stored.pixel == pytest.approx(pixel, rel=1e-12)
    # single precision of 15 um
    np.testing.assert_allclose(stored.values, 1e-3 * (HEIGHTS - MIDDLE), atol=1e-9)


def test_a_map_in_x3p(topography, tmp_path):
    topography.to_x3p(str(tmp_path / "map.x3p"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # an importer without mpi warns nobody
        check(read_height_map(tmp_path / "map.x3p"))
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


def plux_file(path):
    """Write the map in the format of Sensofar: single precision in um, row by row."""
    index = (
        "<xml><GENERAL><DATE>Thu Jan 1 10:00:00 2026</DATE><IMAGE_SIZE_X>5</IMAGE_SIZE_X>"
        "<IMAGE_SIZE_Y>6</IMAGE_SIZE_Y><FOV_X>2</FOV_X><FOV_Y>3</FOV_Y></GENERAL>"
        "<INFO><ITEM_0><NAME>Device</NAME><VALUE>S</VALUE></ITEM_0></INFO><LAYER_0><FILENAME_Z>LAYER_0.raw</FILENAME_Z></LAYER_0></xml>"
    )
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("index.xml", index)
        file.writestr("LAYER_0.raw", HEIGHTS[::-1].astype("<f4").tobytes())


@pytest.mark.parametrize(("name", "written"), [("map.sur", sur_file), ("map.plux", plux_file)])
def test_maps_of_instruments(tmp_path, name, written):
    written(tmp_path / name)
    stored = read_height_map(tmp_path / name)
    # a header in single precision
    assert stored.pixel == pytest.approx((2e-3, 3e-3), rel=1e-6)
    np.testing.assert_allclose(stored.values, 1e-3 * (HEIGHTS - MIDDLE), atol=1e-8)


@pytest.mark.parametrize("name", ["map.sur", "map.x3p"])
def test_a_damaged_map_is_named(tmp_path, name):
    (tmp_path / name).write_text("DIGITAL SURF and then nothing")
    with pytest.raises(mf.InvalidInput, match=f"{name} cannot be read as a height map"):
        read_height_map(tmp_path / name)
