"""What is written into a file is read back, and a damaged file is named."""

import numpy as np
import pytest
import xarray as xr

import metafem as mf
from metafem import files
from metafem.calibration import fit_compression, shear
from metafem.files.calibrated import calibration_data, calibration_text
from metafem.files.result import plain_data
from tests.calibration.contacts import table_of
from tests.core.files.specs import small, text

MATERIAL, BLOCK = mf.Material(1.36), mf.Block(8.0, 8.0, 4.0)
CAPS = [mf.Power(4, 0.3), mf.Sphere(), mf.Paraboloid(), mf.Power(4, 0.3)]
MIXED = mf.Surface.square_lattice(
    [0.1, 0.11, 0.1 + 0.047, 0.13], (2, 2), radius=[0.5, 0.5, 0.6, 0.7], material=MATERIAL, cap=CAPS,
    block=BLOCK,
    friction=mf.Friction(0.4, 0.85),
)  # fmt: skip
NONE = np.full((2, 2), np.nan)
CONTACTS = table_of(
    ('1, "a".tif:1', "#2.tif"), ("", "b"), np.array([0.1 / 3.0, np.nan]), np.array([np.nan, 1e-7]),
    np.array([[0.0, -1.0 / 3.0], [1.5e3, 0.0]]), np.array([7, 3]), True,
    np.array([[0.1, 0.0], [np.nan, 2.0 / 3.0]]),
    np.array([[0.001, 0.0], [np.nan, 0.01]]), np.array([[0.08, np.nan], [np.nan, 0.5]]),
    np.array([[0.001, np.nan], [np.nan, 0.01]]),
)  # fmt: skip
A = np.linspace(0.08, 0.4, 20)
PRESSED = fit_compression(1.36 * 4.0 / 3.0 * A**3 / 0.526, np.pi * A**2, 0.526)
SHEARED = shear(np.pi * A**2, 0.85 * np.pi * A**2, 0.3145 * np.pi * A**2)
STUDY = xr.Dataset(
    {"slope": (("load",), [1.0, np.nan, 2.0 / 3.0], {"units": "mm"})},
    attrs={"study": "interaction", "notes": ""},
)


def write_calibration(path):
    path.write_text(calibration_text(PRESSED, SHEARED), "utf-8")


def write_specification(path):
    path.write_text(text(), "utf-8")


def parameters():
    data = calibration_data(PRESSED, SHEARED)["covariance"]
    return [data["parameters"], data["values"], data["matrix"]]


# How each file is written and read, and what is then equal to what was written.
FILES = {
    "design.json": (
        lambda path: mf.save(small()[1], path.parent, force=True), lambda path: mf.load(path.parent),
        lambda: small()[1],
    ),
    "heights.csv": (
        lambda path: path.write_text(files.heights_table(MIXED, np.arange(4)), "utf-8"),
        lambda path: files.read_surface(path, MATERIAL, friction=MIXED.friction, block=BLOCK),
        lambda: MIXED.replaced(height=[0.1, 0.11, 0.147, 0.13]),  # without the rounding error of a sum
    ),
    "contacts.csv": (
        lambda path: path.write_text(files.contacts_table(CONTACTS), "utf-8"),
        lambda path: plain_data(files.read_contacts(path).to_dict("list")),
        lambda: plain_data(CONTACTS.to_dict("list")),
    ),
    "calibration.toml": (
        write_calibration, lambda path: plain_data(files.read_parameters(path)), parameters,
    ),
    "interaction.nc": (
        lambda path: files.write_study(STUDY, path, force=True),
        lambda path: files.stored_studies(path.parent)["interaction"].to_dict(),
        STUDY.to_dict,
    ),
    "spec.toml": (
        write_specification, lambda path: mf.read_spec(path).files, lambda: {"spec.toml": text().encode()},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FILES)
def test_a_file_is_written_read_equal_and_refused_if_damaged(name, tmp_path):
    write, read, expected = FILES[name]
    path = tmp_path / "out" / name
    path.parent.mkdir()
    write(path)
    np.testing.assert_equal(read(path), expected())
    whole = path.read_bytes()
    write(path)
    assert name.endswith("nc") or path.read_bytes() == whole
    for content in (b"", whole[: 2 * len(whole) // 3], b"\0\xff" + whole):
        path.write_bytes(content)
        with pytest.raises(mf.InvalidInput, match=name):
            read(path)
