"""Tables of measured laws: units, errors of measurement, and what is no such table."""

import numpy as np
import pytest

import metafem as mf
from metafem.calibration import ContactTable
from metafem.files import read_measured_law
from metafem.files.measurement.contacts import contacts_table

MATERIAL, FRICTION = mf.Material(1.36), mf.Friction(0.404, 0.85)


@pytest.fixture
def read(tmp_path):
    def call(text, friction=FRICTION, **given):
        path = tmp_path / "measured.csv"
        path.write_text(text, "utf-8")
        return read_measured_law(path, MATERIAL, friction, **given)

    return call


def test_columns_are_read_in_any_unit_and_order(read):
    law = read("friction_force_mN,load_N,load_sd_mN\n90,0.2,2\n50,0.1,1\n")
    np.testing.assert_array_equal(law.load, [0.1, 0.2])
    np.testing.assert_array_equal(law.friction_force, [0.05, 0.09])
    np.testing.assert_array_equal(law.load_sd, [1e-3, 2e-3])
    np.testing.assert_allclose(law.friction_force_sd, [1.5e-3, 1.9e-3])  # of the paper
    decimal = read("load_N;area_um2\n0,1;100000\n0,2;200000\n")
    np.testing.assert_array_equal(decimal.area, [0.1, 0.2])


def test_contacts_of_images_are_a_measured_law(read):
    area = np.array([[0.1, 0.2], [0.3, 0.4]])
    none = np.full((2, 2), np.nan)
    table = ContactTable(
        ("a.tif", "b.tif"), ("", ""), np.array([0.1, 0.3]), np.full(2, np.nan), np.array([[0.0, 0], [1, 0]]),
        np.array([4, 7]), True, area, 0.01 * area, none, none,
    )  # fmt: skip
    law = read(contacts_table(table))
    np.testing.assert_allclose(law.area, [0.3, 0.7])
    assert law.site.tolist() == [4, 7]
    assert read(contacts_table(table), sites=np.array([7, 2, 4])).site.tolist() == [2, 0]
    with pytest.raises(mf.InvalidInput, match=r"site 4, which the design leaves empty"):
        read(contacts_table(table), sites=np.array([7, 2, 5]))
    other_unit = read(contacts_table(table).replace("load_N", "load_mN"))
    np.testing.assert_allclose(other_unit.load, 1e-3 * law.load)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("load,area_mm2\n1,1\n", "column load needs a unit in its name; write load_mN"),
        ("load_mm,area_mm2\n1,1\n", 'column load_mm has the unit "mm", which does not measure in N'),
        ("load_N,area_furlong\n1,1\n", "column area_furlong .*; write area_mm2"),
        ("load_N,stress_MPa\n1,1\n", "has the columns load_N, stress_MPa; name its columns load_mN,"),
        ("area_mm2,friction_force_N\n1,1\n", "name its columns load_mN,"),
        ("load_N,load_mN,area_mm2\n1,1,1\n", "load is in two columns"),
        ("load_N,area_mm2,friction_force_sd_mN\n1,1,1\n", "friction_force_sd_mN without friction_force"),
        ("load_N,area_mm2\n", "holds no measured point"),
        ("load_N,area_mm2\n1,x\n", "line 2: area_mm2 = 'x' is not a finite number"),
        ("load_N,area_mm2\n1\n", "line 2 has 1 entries"),
        ("load_N,area_mm2,area_sd_mm2\n1,1,1\n#\n2,2,0\n", "line 4: area_sd_mm2 = 0 must be greater than 0"),
        ("load_mN,area_mm2\n100,1\n-200,2\n", "line 3: load_mN = -200 is below 0 by 40 standard deviations"),
        (
            "load_mN,friction_force_mN\n300,20\n100,900\n",
            "line 3: friction_force_mN = 900 at 100 and .*line 2: friction_force_mN = 20 at 300: it decr",
        ),
    ],
)  # fmt: skip
def test_a_table_that_is_no_law_is_refused_by_line_and_column(read, text, words):
    with pytest.raises(mf.InvalidInput, match=words):
        read(text)


def test_friction_forces_need_a_friction(read):
    with pytest.raises(mf.InvalidInput, match="a shear strength and an area ratio; state them"):
        read("load_N,friction_force_N\n1,1\n", None)
