from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from metafem.calibration import ContactTable
from metafem.errors import InvalidInput
from metafem.files.atomic import MARKS
from metafem.files.measurement.contacts import HEADER, contacts_table, read_contacts
from metafem.progress import listening


def table_of(k, n, matched, rng, **more):
    """Return a table of k images and n contacts with numbers of 17 digits, some not measured."""
    area, sheared = rng.random((2, k, n))
    area[rng.random((k, n)) < 0.2] = 0.0
    area[rng.random((k, n)) < 0.2] = np.nan
    sheared[rng.random((k, n)) < 0.5] = np.nan
    values = {
        "image": tuple(f'{i}, a"b.tif:{i + 1}' for i in range(k)),
        "test": tuple(rng.choice(["", "first", "#2"], k).tolist()),
        "load": np.where(rng.random(k) < 0.2, np.nan, rng.normal(size=k)),
        "friction_force": np.where(rng.random(k) < 0.5, np.nan, rng.random(k) * 1e-7),
        "position": rng.normal(size=(n, 2)) * 1e3,
        "site": rng.permutation(3 * n)[:n] if matched else np.arange(n),
        "matched": matched,
        "area": area,
        "area_error": 0.01 * area,
        "sheared_area": sheared,
        "sheared_area_error": 0.01 * sheared,
    }
    return ContactTable(**{**values, **more})


@settings(max_examples=25, deadline=None)
@given(k=st.integers(1, 4), n=st.integers(1, 5), matched=st.booleans(), seed=st.integers(0, 2**32 - 1))
def test_what_is_written_is_read_to_the_bit(tmp_path_factory, k, n, matched, seed):
    table = table_of(k, n, matched, np.random.default_rng(seed))
    what = f"site {table.site[-1]}" if matched else f"contact {n}"
    table = replace(
        table,
        remarks=(
            "two regions belong to no site: 1.tif",
            f"{table.image[0]}: its background is uneven",
            f"{table.image[-1]}, {what}: at the edge of the frame",
            f"{table.image[-1]}, {what}: merged",
        ),
    )
    path = tmp_path_factory.mktemp("table") / "contacts.csv"
    text = contacts_table(table)
    path.write_text(text, encoding="utf-8")
    read = read_contacts(path)
    assert read == table
    assert contacts_table(read) == text
    assert text.encode().startswith(MARKS["contacts"])


def test_one_line_for_each_image_and_contact():
    one, none = np.array([[0.1, 0.0]]), np.full((1, 2), np.nan)
    table = ContactTable(
        ("1.tif",), ("a",), np.array([0.05]), np.array([np.nan]), np.array([[0.0, -0.0], [1.5, 0.0]]),
        np.array([7, 3]), True, one, 0.01 * one, none, none, ("1.tif, site 3: not seen",),
    )  # fmt: skip
    assert contacts_table(table).splitlines() == [
        HEADER,
        "1.tif,a,0.05,,1,7,0.0,0.0,0.1,0.001,,,",
        "1.tif,a,0.05,,2,3,1.5,0.0,0.0,0.0,,,not seen",
    ]
    with pytest.raises(InvalidInput, match=r"image 1.tif of test 'a' is in the table twice"):
        contacts_table(replace(table, image=("1.tif", "1.tif"), test=("a", "a")))


def test_images_of_one_name_in_two_tests(tmp_path):
    none = np.full((2, 1), np.nan)
    table = ContactTable(
        ("1.tif", "1.tif"), ("a", "b"), np.ones(2), none[:, 0], np.zeros((1, 2)), np.arange(1), False,
        none, none, none, none, ("1.tif of test a, contact 1: not seen", "1.tif of test b: dark"),
    )  # fmt: skip
    assert read_contacts(written(tmp_path, contacts_table(table))) == table


def written(tmp_path, text):
    path = tmp_path / "contacts.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_table_of_a_person(tmp_path):
    text = """image;load_mN;contact;x_um;y_um;area_um2;area_error_um2;by
    # measured on Monday
    a.tif;50,5;4;0;0;1e4;200;me
    a.tif;50,5;2;1500;0;0;0;me
    b.tif;60;2;1500;0;;;me
    b.tif;60;4;0;0;2e4;200;me
    """
    heard = []
    with listening(lambda step, done: None, heard.append):
        table = read_contacts(written(tmp_path, text))
    assert heard[0].endswith("the column by is not read")
    assert table.image == ("a.tif", "b.tif")
    assert table.load.tolist() == [0.0505, 0.06]
    assert table.position.tolist() == [[0.0, 0.0], [1.5, 0.0]]
    np.testing.assert_array_equal(table.area, [[0.01, 0.0], [0.02, np.nan]])
    assert not table.matched
    assert table.test == ("", "")
    assert np.isnan(table.friction_force).all()


GOOD = [
    "image,load_N,contact,site,x_mm,y_mm,area_mm2,area_error_mm2",
    "a.tif,0.05,1,3,0,0,0.1,0.01",
    "a.tif,0.05,2,4,1.5,0,0.2,0.01",
    "b.tif,0.06,1,3,0,0,0.1,0.01",
    "b.tif,0.06,2,4,1.5,0,0.2,0.01",
]


@pytest.mark.parametrize(("line", "old", "new", "message"), [
    (3, "0.2", "-0.2", "line 3: area_mm2 = -0.2 must not be negative"),
    (3, "0.2", "0.2mm", "line 3: area_mm2 = '0.2mm' is not a finite number"),
    (3, "0.2", "nan", "line 3: area_mm2 = 'nan' is not a finite number"),
    (3, "0.2", "", "line 3: area_mm2 is empty, and area_error_mm2 is not; write both or none"),
    (3, "0.01", "", "line 3: area_error_mm2 is empty, and area_mm2 is not"),
    (3, "0.01", "-1", "line 3: area_error_mm2 = -1 must not be negative"),
    (3, "0.05", "0.06", "line 3: load_N = '0.06' differs from line 2; the image has one value"),
    (3, ",2,", ",1.5,", "line 3: contact = '1.5' must be a whole number of at least 1"),
    (3, ",2,", ",0,", "line 3: contact = '0' must be a whole number of at least 1"),
    (3, ",2,", ",1,", "line 3: contact = 1 of image a.tif is in line 2 too; keep one"),
    (5, ",2,", ",3,", "image a.tif lacks contact 3, which others have"),
    (5, ",4,", ",3,", "line 5: site = '3' differs from line 3; the contact has one value"),
    (5, ",4,", ",,", "line 5: site = '' must be a whole number of at least 0"),
    (3, "a.tif", "", "line 3: image is empty; write the name of the image"),
    (5, "1.5", "1.6", "line 5: x_mm = '1.6' differs from line 3; the contact has one value"),
    (3, "1.5", "", "line 3: x_mm is empty; write the contact's position"),
    (1, "site", "y_mm", "y is in two columns; keep one"),
    (1, "area_mm2", "area_mm", 'column area_mm has the unit "mm", which does not measure in'),
    (1, "area_mm2", "size_mm2", "lacks area_mm2: it has the columns"),
    (2, ",0.01", ",0.01,5", "line 2 has 9 entries; the first names 8"),
])  # fmt: skip
def test_a_bad_cell_is_named(tmp_path, line, old, new, message):
    lines = list(GOOD)
    assert old in lines[line - 1]
    lines[line - 1] = lines[line - 1].replace(old, new, 1)
    with pytest.raises(InvalidInput) as caught:
        read_contacts(written(tmp_path, "\n".join(lines)))
    assert message in str(caught.value)
    assert "contacts.csv" in str(caught.value)


def test_two_contacts_of_one_site_and_an_empty_table(tmp_path):
    text = "\n".join(GOOD).replace(",4,", ",3,")
    with pytest.raises(InvalidInput, match="line 3: site = 3 is the site of another contact too"):
        read_contacts(written(tmp_path, text))
    with pytest.raises(InvalidInput, match="names columns but holds no contact"):
        read_contacts(written(tmp_path, GOOD[0]))
