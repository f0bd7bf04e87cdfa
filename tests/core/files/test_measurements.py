"""Tables of measurements and images are read with their units."""

import json
import math
import tomllib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import tifffile
from PIL import Image

import metafem as mf
from metafem import files
from metafem.calibration import fit_compression, shear
from metafem.files.calibrated import calibration_data
from metafem.files.images import natural
from metafem.progress import listening
from tests.calibration.contacts import table_of
from tests.core.files.specs import spec
from tests.core.files.test_files import CONTACTS, MIXED, PRESSED, SHEARED, A

MATERIAL, FRICTION = mf.Material(1.36), mf.Friction(0.404, 0.85)


@pytest.fixture
def read(tmp_path, monkeypatch):
    """Write tables into an empty folder and pool them."""
    monkeypatch.chdir(tmp_path)

    def call(*tables, **options):
        for name, table in zip("abc", tables, strict=False):
            Path(f"{name}.csv").write_text(table, "utf-8")
        found = files.read_calibration([f"{name}.csv" for name in "abc"[: len(tables)]], **options)
        return SimpleNamespace(**dict(zip(("compression", "shear", "boundary", "notes"), found, strict=True)))

    return call


def test_a_measured_law_is_read_in_any_unit_and_order(tmp_path):
    path = tmp_path / "a.csv"

    def law(table, **given):
        path.write_text(table, "utf-8")
        return files.read_measured_law(path, MATERIAL, FRICTION, **given)

    found = law("friction_force_mN,load_N,load_sd_mN\n90,0.2,2\n50,0.1,1\n")
    assert (found.load.tolist(), found.friction_force.tolist()) == ([0.1, 0.2], [0.05, 0.09])
    np.testing.assert_array_equal(found.load_sd, [1e-3, 2e-3])
    np.testing.assert_allclose(found.friction_force_sd, [1.5e-3, 1.9e-3], rtol=1e-12)  # of the paper
    found = law("load_N;area_um2;area_sd_mm2\n0,1;100000;,01\n0,2;200000;,02\n")
    assert (found.area.tolist(), found.area_sd.tolist()) == ([0.1, 0.2], [0.01, 0.02])
    area = np.array([[0.1, 0.2], [0.3, 0.4]])
    names = ("1.tif", "2.tif")
    images = files.contacts_table(
        table_of(names, "", [0.1, 0.2], np.nan, np.zeros((2, 2)), [7, 3], True, area, 0.01 * area)
    )
    found = law(images)
    assert (found.site.tolist(), found.load.tolist()) == ([7, 3], [0.1, 0.2])
    np.testing.assert_allclose(found.area, [0.3, 0.7], rtol=1e-12)
    assert law(images, sites=np.array([3, 5, 7])).site.tolist() == [2, 0]
    assert law(images.replace("load_N", "load_mN")).load.tolist() == [1e-4, 2e-4]


def test_contacts_have_one_line_for_each_image_and_contact(tmp_path):
    assert files.contacts_table(CONTACTS).splitlines()[:4] == [
        "image,test,load_N,friction_force_N,contact,site,x_mm,y_mm,area_mm2,area_error_mm2,sheared_area_mm2,"
        "sheared_area_error_mm2",
        '"1, ""a"".tif:1","",0.03333333333333333,"",1,8,0.0,-0.3333333333333333,0.1,0.001,0.08,0.001',
        '"1, ""a"".tif:1","",0.03333333333333333,"",2,4,1500.0,0.0,0.0,0.0,"",""',
        '"#2.tif","b","",1e-07,1,8,0.0,-0.3333333333333333,"","","",""',
    ]
    with pytest.raises(mf.InvalidInput, match=r"image 1 is in one test twice"):
        files.contacts_table(CONTACTS.assign(image="1", test="a"))
    path = tmp_path / "contacts.csv"
    path.write_text(
        "image;load_mN;contact;x_um;y_um;area_um2;area_error_um2;by\n# by hand\na.tif;50,5;4;0;0;1e4;200;me\n"
        "a.tif;50,5;2;1500;0;0;0;me\nb.tif;60;2;1500;0;;;me\nb.tif;60;4;0;0;2e4;200;me\n", "utf-8",
    )  # fmt: skip
    heard = []
    with listening(lambda step, done: None, heard.append):
        table = files.read_contacts(path)
    assert heard[0].endswith("the column by is not read")
    assert table["image"].tolist() == ["a.tif", "a.tif", "b.tif", "b.tif"]
    assert table[["load", "contact", "x", "y"]].to_numpy().tolist() == [
        [0.0505, 4, 0.0, 0.0], [0.0505, 2, 1.5, 0.0], [0.06, 4, 0.0, 0.0], [0.06, 2, 1.5, 0.0],
    ]  # fmt: skip
    assert table["site"].isna().all()
    np.testing.assert_array_equal(table["area"], [0.01, 0.0, 0.02, np.nan])


def test_compression_tests_are_pooled_with_their_labels(read):
    one = "load_mN,area_um2\n10,100000\n20,200000\n"
    labelled = "load_mN;area_mm2;test\n10,5;0,1;first\n20;0,2;second\n"
    data = read(one, labelled)
    points = data.compression
    assert points["load"].tolist() == [0.01, 0.02, 0.0105, 0.02]
    assert points["area"].tolist() == [0.1, 0.2, 0.1, 0.2]
    assert points["test"].tolist() == ["a", "a", "first", "second"]
    assert data.shear is None
    Path("d").mkdir()
    for name in ("a.csv", "d/a.csv"):
        Path(name).write_text(one, "utf-8")
    assert files.read_calibration(["a.csv", "d/a.csv"])[0]["test"].tolist() == [
        "a",
        "a",
        "d/a",
        "d/a",
    ]
    with pytest.raises(mf.InvalidInput, match=r"a\.csv is given twice"):
        files.read_calibration(["a.csv", "./a.csv"])


def test_shear_tests_are_points(read):
    table = "load_mN,area_mm2,area_sheared_mm2,friction_force_mN\n10,0.1,0.085,31\n20,0.15,,\n,0.2,0.17,63\n"
    data = read(table)
    assert data.compression["load"].tolist() == [0.01, 0.02]
    assert data.shear["area_before"].tolist() == [0.1, 0.15, 0.2]
    np.testing.assert_array_equal(data.shear["area_sheared"], [0.085, np.nan, 0.17])
    np.testing.assert_array_equal(data.shear["friction_force"], [0.031, np.nan, 0.063])
    assert "covariance of their errors is left out" in str(data.notes[0])
    assert read("area_sheared_mm2,friction_force_mN\n0.085,31\n").shear["area_before"].isna().all()


def test_contacts_of_images_are_points(read):
    area = np.array([[0.1, 0.2], [0.15, np.nan], [0.2, 0.3]])
    table = table_of(
        ("1", "2", "3"), ("", "", "b"), [0.05, 0.08, np.nan], [0.09, 0.13, 0.15], np.zeros((2, 2)), [7, 3],
        True, area, 2e-3 * np.sqrt(np.pi * area), 0.85 * area, 0.01 * area,
    )  # fmt: skip
    data = read(files.contacts_table(table))
    pressed, slid = data.compression, data.shear
    assert pressed[["load", "area_1", "area_2"]].values.tolist() == [[0.05, 0.1, 0.2]]
    np.testing.assert_allclose(slid["area_before"], [0.3, 0.15, 0.5], rtol=1e-12)
    np.testing.assert_array_equal(slid["friction_force"], [0.09, np.nan, 0.15])
    assert slid["test"].tolist() == ["a", "a", "b"]
    assert [note.text.partition(":")[0] for note in data.notes] == ["a.csv"] * 3
    assert data.boundary == pytest.approx(1e-3, rel=1e-12)
    whole = "load_mN,area_mm2\n1,2\n"
    with pytest.raises(mf.InvalidInput, match="different numbers of contacts"):
        read(files.contacts_table(table), whole)
    assert read(files.contacts_table(table), "area_sheared_mm2,friction_force_mN\n1,2\n").boundary is None


def test_images_have_their_forces_in_their_own_order(tmp_path):
    names, path = ["1.tif", "2.tif", "10.tif", "s.tif:1"], tmp_path / "f.csv"
    path.write_text(
        "image;load_mN;friction_force_N;sheared_image;test\n10.tif;200,5;;9.tif;b\n"
        "1.tif;50;0,1;2.tif;a\n3.tif;6;;;\n", "utf-8",
    )  # fmt: skip
    found, notes = files.read_forces(names, path)
    assert found["image"].tolist() == ["1.tif", "10.tif", "s.tif:1"]
    assert found["sheared_image"].tolist() == ["2.tif", "", ""]
    assert found["test"].tolist() == ["a", "b", ""]
    np.testing.assert_array_equal(found["load"], [0.05, 0.2005, np.nan])
    np.testing.assert_array_equal(found["friction_force"], [0.1, np.nan, np.nan])
    assert ["3.tif, 9.tif" in str(notes[0]), str(notes[1])[:7], len(notes)] == [True, "s.tif:1", 2]
    alone, notes = files.read_forces(names, None)
    assert (alone["image"].tolist(), notes) == (names, [])


def test_sites_are_read_with_and_without_numbers(tmp_path):
    path = tmp_path / "heights.csv"
    for table, numbers in (
        ("site,x_mm,y_um,z\n7,0,1500,1\n3,1.5,0,1\n", [6, 2]), ("x_mm,y_mm\n0,1.5\n1.5,0\n", [0, 1])
    ):  # fmt: skip
        path.write_text(table, "utf-8")
        position, number = files.read_sites(path)
        assert (position.tolist(), number.tolist()) == ([[0.0, 1.5], [1.5, 0.0]], numbers)


def test_columns_of_own_tables_that_are_not_read_are_not_mentioned(tmp_path):
    heard, path = [], tmp_path / "own.csv"
    lattice = MIXED.replaced(cell=mf.PeriodicCell(4.5, 5.0), block=None)
    law = mf.friction_law(lattice, mf.Independent(mf.Elastic()), load=[0.1, 0.2])
    with listening(lambda step, done: None, heard.append):
        for table, read in (
            (files.heights_table(MIXED, np.arange(4)), files.read_sites),
            (files.law_table(law), files.read_law),
        ):
            path.write_text(table, "utf-8")
            read(path)
    assert heard == []


def load_of(energy):
    """Return exact loads with an adhesion energy [N/mm]."""
    return 1.36 * 4.0 / 3.0 * A**3 / 0.526 - math.sqrt(8.0 * math.pi * energy * 1.36) * A**1.5


def adhesive(energy):
    """Return the calibration of exact points with an adhesion energy [N/mm]."""
    return fit_compression(load_of(energy), np.pi * A**2, 0.526)


def test_a_calibration_is_written_as_sections():
    found = adhesive(5e-4)
    whole = files.calibration_text(found, SHEARED, sources=["a.csv", "b.csv"])
    assert whole.startswith("# Calibration by metafem: sections of a specification")
    assert "# Measured: a.csv\n# Measured: b.csv\n" in whole
    table = tomllib.loads(whole)
    assert table.pop("covariance")["parameters"] == ["composite_modulus", "area_ratio", "shear_strength"]
    assert list(table) == ["material", "contact", "friction"]
    read = spec(**{name: toml(keys) for name, keys in table.items()})
    assert read.template.material.composite_modulus == pytest.approx(1.36, abs=6e-4)
    assert read.template.friction.shear_strength == pytest.approx(0.37, abs=1e-4)
    assert read.template.friction.area_ratio == pytest.approx(0.85, abs=1e-4)
    assert read.model.contact.adhesion_energy == pytest.approx(5e-4, rel=0.02)
    doubtful = files.calibration_text(adhesive(1e-7))
    assert 'kind = "hertz"\n# The adhesion energy is 0 to' in doubtful
    bent = files.calibration_text(shear(np.pi * A**2, 0.85 * np.pi * A**2, 0.3145 * np.pi * A**2 + 0.01))
    assert list(tomllib.loads(bent)) == ["friction", "covariance"]
    assert "the law does not fit" in bent


def toml(keys):
    """Return the lines of a section; a section in it has dotted keys."""
    parts = ({f"{name}.{key}": each for key, each in part.items()} if isinstance(part, dict) else {name: part}
             for name, part in keys.items())  # fmt: skip
    return "\n".join(f"{name} = {json.dumps(value)}" for part in parts for name, value in part.items())


def test_without_adhesion_the_modulus_is_that_of_no_adhesion():
    rising = load_of(1e-5)
    found = fit_compression(2.0 * 1.36 * 4.0 / 3.0 * A**3 / 0.526 - rising, np.pi * A**2, 0.526)
    assert found.estimates["adhesion_energy"].value == 0.0
    modulus, sd, _ = found.estimates["composite_modulus"]
    table = tomllib.loads(files.calibration_text(found))
    assert table["contact"] == {"kind": "hertz"}
    written = float(table["material"]["composite_modulus"].removesuffix(" MPa"))
    assert written == pytest.approx(modulus, abs=0.01 * sd)
    assert table["covariance"]["values"] == [modulus]


def test_a_calibration_is_written_as_data():
    data = calibration_data(PRESSED, SHEARED)
    assert list(data) == ["compression", "shear", "covariance"]
    covariance = data["covariance"]
    assert covariance["units"] == ["MPa", "1", "MPa"]
    np.testing.assert_allclose(covariance["values"], [1.36, 0.85, 0.37], rtol=1e-6)
    np.testing.assert_allclose(np.array(covariance["matrix"])[1:, 1:], SHEARED.covariance, rtol=1e-12)
    assert data["shear"]["verdict"]["freedom"] == 38
    modulus, sd, interval = PRESSED.estimates["composite_modulus"]
    pressed = data["compression"]
    names = ("composite_modulus_MPa", "composite_modulus_sd_MPa", "composite_modulus_interval_MPa")
    assert [pressed[name] for name in names] == [modulus, sd, list(interval)]
    # the second test has twice the load
    load, labels = load_of(0.0), ["a"] * 20 + ["b"] * 20
    both = fit_compression(np.append(load, 2.0 * load), np.tile(np.pi * A**2, 2), 0.526, test=labels)
    both = calibration_data(both)["compression"]
    assert both["heterogeneity"]["fits"] is False


def test_images_of_all_kinds_have_their_grey_levels(tmp_path):
    grey = np.random.default_rng(0).integers(0, 256, (3, 16, 20), dtype=np.uint8)
    luminance = np.rint(np.moveaxis(grey, 0, -1) @ [0.2126, 0.7152, 0.0722])
    Image.fromarray(grey[0]).save(tmp_path / "2.png")
    Image.fromarray(grey[0].astype(np.uint16) * 257).save(tmp_path / "10.png")
    Image.fromarray(np.moveaxis(grey, 0, -1)).save(tmp_path / "3.png")
    floats = grey.astype(np.float32)
    tifffile.imwrite(tmp_path / "4.tif", floats, compression="zlib", photometric="minisblack")
    tifffile.imwrite(tmp_path / "5.tif", grey[0], photometric="miniswhite")
    palette = np.tile(257 * np.arange(256, dtype=np.uint16), (3, 1))
    tifffile.imwrite(tmp_path / "6.tif", grey[0], photometric="palette", colormap=palette)
    first, *others = (Image.fromarray(page) for page in grey)
    first.save(tmp_path / "7.tiff", compression="tiff_lzw", save_all=True, append_images=others)
    tifffile.imwrite(tmp_path / "8.tif", grey[0].astype(np.uint16), byteorder=">")
    (tmp_path / "9.jpg").touch()
    (tmp_path / ".1.png").touch()
    images = files.find_images([tmp_path])
    expected = {
        "2.png": grey[0], "3.png": luminance, **{f"4.tif:{i + 1}": grey[i] for i in range(3)},
        "5.tif": 255 - grey[0], "6.tif": grey[0], **{f"7.tiff:{i + 1}": grey[i] for i in range(3)},
        "8.tif": grey[0], "10.png": 257.0 * grey[0],
    }  # fmt: skip
    assert list(images) == list(expected)
    for name, values in expected.items():
        np.testing.assert_allclose(images[name](), values, err_msg=name)
    assert sorted(["a10", "a2", "A1", "b"], key=natural) == ["A1", "a2", "a10", "b"]
    (tmp_path / "4.tif").write_bytes((tmp_path / "4.tif").read_bytes()[:-40])
    (tmp_path / "5.tif").write_bytes(b"")
    (tmp_path / "2.png").write_bytes((tmp_path / "2.png").read_bytes()[:100])
    for name in ("4.tif", "5.tif", "2.png"):
        with pytest.raises(mf.InvalidInput, match=rf"^{name}(:3)? cannot be read"):
            [*files.find_images([tmp_path / name]).values()][-1]()
    (tmp_path / "empty").mkdir()
    for names in (["empty"], ["9.jpg"], ["none.tif"], ["3.png", "3.png"]):
        with pytest.raises(mf.InvalidInput, match=names[0]):
            files.find_images([tmp_path / name for name in names])
