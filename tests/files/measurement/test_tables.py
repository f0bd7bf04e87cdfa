"""Tables of tests: columns, units, empty entries, records, contacts in images, and what is refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from metafem._given import Names
from metafem.calibration import ContactTable
from metafem.errors import InvalidInput
from metafem.files import of_tables, read_calibration
from metafem.files.measurement.contacts import contacts_table


@pytest.fixture
def read(tmp_path, monkeypatch):
    """Write tables into an empty folder and read them by name."""
    monkeypatch.chdir(tmp_path)

    def call(tables, **options):
        for name, text in tables.items():
            Path(name).write_text(text, "utf-8")
        return read_calibration(list(tables), **options)

    return call


PULL = "displacement_um,friction_force_mN,area_mm2\n" + "".join(
    f"{10 * i},{min(i, 15) if i <= 15 else 12},{0.5 - 0.01 * min(i, 15) if i % 5 == 0 else ''}\n"
    for i in range(61)
)


def test_units_of_the_header_are_converted(read):
    data = read({"a.csv": "load_N,area_um2\n0.05,100000\n"})
    assert data.shear is None
    assert (data.compression.load[0], data.compression.area[0]) == (0.05, 0.1)
    assert data.compression.test == ("a",)
    assert data.compression.place == ("a.csv, line 2",)


def test_several_tables_are_pooled_and_each_is_a_test(read):
    table = "load_mN,area_mm2\n10,0.1\n20,0.2\n"
    labelled = "load_mN;area_mm2;test\n10,5;0,1;first\n20;0,2;second\n"
    data = read({"a.csv": table, "b.csv": labelled})
    assert data.compression.load.tolist() == [0.01, 0.02, 0.0105, 0.02]
    assert data.compression.test == ("a", "a", "first", "second")


def test_areas_of_single_contacts_are_in_the_order_of_their_numbers(read):
    data = read({"a.csv": "area_10_mm2,load_mN,area_2_mm2\n0.1,10,0.2\n"})
    assert data.compression.area.tolist() == [[0.2, 0.1]]


def test_single_and_total_areas_become_totals(read):
    single, total = "load_mN,area_1_mm2,area_2_mm2\n10,0.1,0.2\n", "load_mN,area_mm2\n10,0.3\n"
    data = read({"a.csv": single, "b.csv": total})
    assert data.compression.area == pytest.approx([0.3, 0.3])
    assert data.compression.contacts == 2
    assert "the totals are used" in str(data.notes[0])


def test_tables_of_different_numbers_of_contacts_are_not_pooled(read):
    two, three = (
        "load_mN,area_1_mm2,area_2_mm2\n1,2,3\n",
        "load_mN,area_1_mm2,area_2_mm2,area_3_mm2\n1,2,3,4\n",
    )
    with pytest.raises(InvalidInput, match=r"2 \(a.csv, line 2\) and 3 \(b.csv, line 2\) contacts"):
        read({"a.csv": two, "b.csv": three})


def test_one_table_may_hold_compression_and_shear(read):
    data = read(
        {
            "a.csv": "load_mN,area_mm2,area_sheared_mm2,friction_force_mN\n"
            "10,0.1,0.085,31\n20,0.15,,\n,0.2,0.17,63\n"
        }
    )
    assert data.compression.load.tolist() == [0.01, 0.02]
    assert data.shear.area_before.tolist() == [0.1, 0.15, 0.2]
    assert np.isnan(data.shear.area_sheared).tolist() == [False, True, False]
    assert data.shear.friction_force[2] == 0.063
    assert data.shear.place[2] == "a.csv, line 4"


def test_a_shear_table_may_lack_one_quantity(read):
    data = read({"a.csv": "area_sheared_mm2,friction_force_mN\n0.085,31\n"})
    assert data.compression is None
    assert np.isnan(data.shear.area_before).all()
    assert np.isnan(
        read({"b.csv": "area_before_mm2,area_sheared_mm2\n0.1,0.085\n"}).shear.friction_force
    ).all()


def test_records_are_points_of_static_or_sliding_friction(read):
    static = read({"1.csv": PULL, "2.csv": PULL}).shear
    assert static.friction_force.tolist() == [0.015, 0.015]
    assert static.area_sheared == pytest.approx([0.35, 0.35])
    assert static.test == ("records", "records")
    sliding = read({"1.csv": PULL}, sliding=True, sliding_range=(0.2, 0.3))
    assert sliding.shear.friction_force == pytest.approx([0.012])
    assert sliding.records["1.csv"].sliding_range == (0.2, 0.3)


def contacts():
    """Return contacts of which one was not measured in the second image, and none without load."""
    area = np.array([[0.1, 0.2], [0.15, np.nan], [0.2, 0.3]])
    return ContactTable(
        ("1.tif", "2.tif", "3.tif"),
        ("", "", "b"),
        np.array([0.05, 0.08, np.nan]),
        np.array([0.09, 0.13, 0.15]),
        np.array([[0.0, 0.0], [7.1, 0.0]]),
        np.arange(2),
        False,
        area,
        2.0 * 1e-3 * np.sqrt(np.pi * area),
        0.85 * area,
        0.01 * area,
    )


def test_contacts_of_images_are_points(read):
    data = read({"contacts.csv": contacts_table(contacts())})
    assert data.compression.area.tolist() == [[0.1, 0.2]]
    assert data.compression.place == ("contacts.csv, image 1.tif",)
    # the second image still has the ratio of the contact that was measured, but not its force
    assert [str(note).partition(":")[0] for note in data.notes] == ["contacts.csv"] * 2
    assert data.shear.area_before == pytest.approx([0.3, 0.15, 0.5])
    assert np.isnan(data.shear.friction_force).tolist() == [False, True, False]
    assert data.shear.test == ("contacts", "contacts", "b")
    assert data.boundary == pytest.approx(1e-3)
    assert data.position.tolist() == [[0.0, 0.0], [7.1, 0.0]]
    other = read({"contacts.csv": contacts_table(contacts()), "a.csv": "load_mN,area_mm2\n10,0.3\n"})
    assert other.boundary is None


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("load,area_mm2\n1,2\n", "a.csv: column load needs a unit in its name; write load_mN"),
        ("load_mm,area_mm2\n1,2\n", 'column load_mm has the unit "mm", which does not measure in N'),
        ("load_mN,area_1_mN\n1,2\n", 'column area_1_mN has the unit "mN", .* write area_1_mm2'),
        ("load_mN,load_N,area_mm2\n1,2,3\n", "load is in two columns"),
        ("load_mN,area_mm2\n", "names columns but holds no measured point"),
        ("load_mN,area_mm2\n1,2\n3,\n", "a.csv, line 3: area_mm2 = '' is not a finite number"),
        ("load_mN,area_mm2\n1,2\n3\n", "a.csv, line 3 has 1 entries"),
        ("load_mN,height_um\n1,2\n", "columns load_mN, height_um; name its columns load_mN,area_mm2"),
        ("load_mN,friction_force_mN\n1,2\n", "name its columns load_mN,area_mm2 of a compression test"),
        ("load_mN,area_mm2,area_1_mm2\n1,2,3\n", "total area and area_1; keep one"),
        ("area_mm2,area_before_mm2,area_sheared_mm2\n1,2,3\n", "area and area_before, which are the same"),
        ("displacement_um,area_mm2\n1,2\n", "lacks friction_force_mN: it has"),
        ("\n".join(PULL.split("\n")[:12]), "a.csv: friction_force_mN is largest at the last entry"),
        (
            PULL.replace("\n20,", "\n5,"),
            "a.csv, line 4: displacement_um = 5 is less than the one before",
        ),
    ],
)
def test_bad_tables_are_named(read, text, message):
    with pytest.raises(InvalidInput, match=message):
        read({"a.csv": text})


@pytest.mark.parametrize("text", [PULL, "load_mN,area_mm2\n10,0.1\n"])
def test_a_table_is_read_once(read, text):
    Path("1.csv").write_text(text, "utf-8")
    with pytest.raises(InvalidInput, match=r"1\.csv is given twice"):
        read_calibration(["1.csv", "./1.csv"])


def test_files_of_one_name_are_different_tests(read):
    for folder in ("a", "b"):
        Path(folder).mkdir()
    table = "load_mN,area_mm2\n10,0.1\n"
    assert read({"a/1.csv": table, "b/1.csv": table}).compression.test == ("a/1", "b/1")


def test_options_of_records_need_one(read):
    with pytest.raises(InvalidInput, match="--sliding belongs to records of pulls"):
        read({"a.csv": "load_mN,area_mm2\n10,0.1\n"}, sliding=True)
    with pytest.raises(InvalidInput, match="--sliding-range belongs to records"):
        read({"a.csv": "load_mN,area_mm2\n10,0.1\n"}, sliding_range=(0.1, 0.2))


def test_contacts_without_loads_or_sheared_areas_are_refused(read):
    one = contacts()
    bare = ContactTable(
        *(one.image, one.test, one.load * np.nan, one.friction_force, one.position, one.site, one.matched),
        *(one.area, one.area_error, one.area * np.nan, one.area * np.nan),
    )
    with pytest.raises(InvalidInput, match=r"holds neither images with a load .*: no image has a load"):
        read({"contacts.csv": contacts_table(bare)})


def test_a_contact_that_no_image_measures_is_named(read):
    one = contacts()
    edge = replace(
        one,
        area=np.where([True, False], one.area, np.nan),
        area_error=np.where([True, False], one.area_error, np.nan),
    )
    data = read({"contacts.csv": contacts_table(edge)})
    assert data.compression is None
    assert any("area of contact 2" in str(note) and "E* cannot be fitted" in str(note) for note in data.notes)
    bare = replace(edge, sheared_area=one.area * np.nan, sheared_area_error=one.area * np.nan)
    with pytest.raises(InvalidInput, match="contact 2, so that E\\* cannot be fitted"):
        read({"contacts.csv": contacts_table(bare)})


@pytest.mark.parametrize(
    ("text", "message"),
    [("too few points", "a.csv, b.csv: too few points"), ("b.csv, line 2: x", "b.csv, line 2: x")],
)
def test_errors_of_pooled_points_name_the_files(text, message):
    with pytest.raises(InvalidInput) as caught, of_tables(Names(), ["a.csv", "b.csv"]):
        raise InvalidInput(text)
    assert str(caught.value) == message
