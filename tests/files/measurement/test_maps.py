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


@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_an_array_of_numpy(tmp_path, kind):
    np.save(tmp_path / "map.npy", HEIGHTS.astype(kind))
    check(read_height_map(tmp_path / "map.npy", "2 um", "um"), (2e-3, 2e-3))
    nm = read_height_map(tmp_path / "map.npy", "0.002 mm", "nm")
    np.testing.assert_allclose(nm.values, 1e-6 * (HEIGHTS - MIDDLE), atol=1e-12)


@pytest.mark.parametrize("separator", [" ", ",", ";", "\t"])
def test_a_list_of_points_in_any_order_with_holes(tmp_path, separator):
    rows, columns = np.nonzero(np.isfinite(HEIGHTS))
    order = np.random.default_rng(0).permutation(len(rows))
    lines = ["# x y z"]
    for i in order:
        point = 2.0 * columns[i], 3.0 * (5 - rows[i]), HEIGHTS[rows[i], columns[i]]
        lines.append(separator.join(f"{value:.6f}" for value in point))
    (tmp_path / "map.xyz").write_text("\n".join(lines))
    check(read_height_map(tmp_path / "map.xyz", "2 um", "um"))


TEXTS = {
    "text.npy": "no array",
    "damaged.sur": "DIGITAL SURF and then nothing",
    "unknown.map": "?",
    "two.xyz": "0 0\n1 1\n",
    "line.xyz": "0 0 1\n1 0 1\n2 0 1\n",
    "off.xyz": "0 0 1\n1 0 1\n2.4 0 1\n3 0 1\n4 0 1\n0 1 1\n1 1 1\n3 1 1\n4 1 1\n",
    "words.xyz": "0 0 1\n1 0 high\n",
    "empty.xyz": "# nothing\n",
}


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("none.x3p", (), "no such file"),
        ("folder", (), "a folder"),
        ("flat.npy", (), '--pixel "2 um" --height-unit "um"'),
        ("flat.npy", ("2 um",), "--height-unit"),
        ("flat.npy", ("2", "um"), "--pixel .* needs a unit"),
        ("flat.npy", ("-2 um", "um"), "greater than 0"),
        ("flat.npy", ("2 um", "N"), "--height-unit"),
        ("cube.npy", ("2 um", "um"), "rows and columns"),
        ("objects.npy", ("2 um", "um"), "not an array of numpy"),
        ("text.npy", ("2 um", "um"), "not an array of numpy"),
        ("stated.x3p", ("2 um",), "states the size of its pixels; leave --pixel out"),
        ("stated.x3p", (None, "um"), "leave --height-unit out"),
        ("damaged.sur", (), "cannot be read as a height map"),
        ("unknown.map", (), "cannot be read as a height map"),
        ("two.xyz", ("2 um", "um"), "2 columns"),
        ("line.xyz", ("2 um", "um"), "the same y"),
        ("off.xyz", ("2 um", "um"), "point 3, x = 2.4"),
        ("words.xyz", ("2 um", "um"), "not a list of points"),
        ("empty.xyz", ("2 um", "um"), "holds no points"),
    ],
)
def test_what_is_no_map_is_named(name, options, message, tmp_path, topography):
    topography.to_x3p(str(tmp_path / "stated.x3p"))
    np.save(tmp_path / "cube.npy", np.zeros((3, 3, 3)))
    np.save(tmp_path / "objects.npy", np.array([{}]), allow_pickle=True)
    np.save(tmp_path / "flat.npy", HEIGHTS)
    (tmp_path / "folder").mkdir()
    for other, text in TEXTS.items():
        (tmp_path / other).write_text(text)
    with pytest.raises(mf.InvalidInput, match=message):
        read_height_map(tmp_path / name, *options)
