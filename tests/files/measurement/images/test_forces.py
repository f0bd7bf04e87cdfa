import math
from pathlib import Path

import pytest

from metafem.errors import InvalidInput
from metafem.files.measurement.images.forces import shots
from metafem.files.measurement.images.pages import ImageFile

IMAGES = [ImageFile(name, Path(name.partition(":")[0])) for name in ("1.tif", "2.tif", "10.tif", "s.tif:1")]


def table(tmp_path, text):
    path = tmp_path / "forces.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_images_have_their_forces_in_their_own_order(tmp_path):
    path = table(
        tmp_path,
        "image;load_mN;friction_force_N;sheared_image;test\n10.tif;200,5;;;b\n1.tif;50;0,1;2.tif;a\n",
    )
    found, notes = shots(IMAGES, path)
    assert [(shot.image.name, shot.load, shot.test) for shot in found[:2]] == [
        ("1.tif", 0.05, "a"), ("10.tif", 0.2005, "b"),
    ]  # fmt: skip
    assert found[0].sheared is IMAGES[1]
    assert found[0].friction_force == 0.1
    assert found[1].sheared is None
    assert math.isnan(found[1].friction_force)
    # an image without a line is measured all the same
    assert found[2].image.name == "s.tif:1"
    assert math.isnan(found[2].load)
    assert [str(note) for note in notes] == ["s.tif:1 is not in the table of forces: the load is empty"]


def test_without_a_table_there_are_no_forces():
    found, notes = shots(IMAGES)
    assert [shot.image for shot in found] == IMAGES
    assert all(math.isnan(shot.load) for shot in found)
    assert notes == []


def test_the_only_page_of_a_file_may_be_numbered(tmp_path):
    found, _ = shots(IMAGES[:1], table(tmp_path, "image,load_N\n1.tif:1,0.1\n"))
    assert found[0].load == 0.1


def test_a_misspelt_column_is_named_with_the_right_name(tmp_path):
    text = "image,load_mN,friction_mN,shear_image,operator\n1.tif,5,6,2.tif,me\n"
    _, notes = shots(IMAGES[:1], table(tmp_path, text))
    assert [str(note) for note in notes] == [
        f"{tmp_path}/forces.csv: the column friction_mN is not read; did you mean friction_force_mN?",
        f"{tmp_path}/forces.csv: the column shear_image is not read; did you mean sheared_image?",
    ]
    assert all(note.warns for note in notes)


def test_a_line_without_its_image_is_left_out(tmp_path):
    text = "image,load_mN,sheared_image\n1.tif,5,2.tif\n3.tif,6,\n10.tif,7,9.tif\n"
    found, notes = shots(IMAGES[:3], table(tmp_path, text))
    assert [(shot.image.name, shot.load, shot.sheared) for shot in found] == [
        ("1.tif", 0.005, IMAGES[1]), ("10.tif", 0.007, None),
    ]  # fmt: skip
    file = f"{tmp_path}/forces.csv"
    assert [str(note).partition("; did")[0] for note in notes] == [
        f"the line is left out: {file}, line 3: image = '3.tif' is not among the images",
        f"the sheared image is left out: {file}, line 4: sheared_image = '9.tif' is not among the images",
    ]


@pytest.mark.parametrize(("text", "message"), [
    ("image,load_mN\n", "names columns but holds no image"),
    ("image,load\n1.tif,5\n", "column load needs a unit in its name; write load_mN"),
    ("image,load_mm\n1.tif,5\n", 'column load_mm has the unit "mm", which does not measure in'),
    ("image,force_mN\n1.tif,5\n", "lacks load_mN: it has the columns image, force_mN; name its"),
    ("name,load_mN\n1.tif,5\n", "lacks image: it has"),
    ("image,load_mN,load_N\n1.tif,5,5\n", "load is in two columns"),
    ("image,load_mN\n1.tif,\n", "line 2: load_mN is empty; write the load of the image"),
    ("image,load_mN\n1.tif,abc\n", "line 2: load_mN = 'abc' is not a finite number"),
    ("image,load_mN\n,5\n", "line 2: image is empty"),
    ("image,load_mN\n3.tif,5\n", "line 2: image = '3.tif' is not among the images; did you mean"),
    ("image,load_mN\ns.tif,5\n", "image = 's.tif' is not among the images; it has 1 pages, name one as"),
    ("image,load_mN\n1.tif,5\n1.tif,6\n", "line 3: image = '1.tif' is in line 2 too"),
    ("image,load_mN,sheared_image\n1.tif,5,1.tif\n", "line 2: sheared_image = '1.tif' is in line 2 too"),
    ("image,load_mN\n1.tif,5,6\n", "line 2 has 3 entries"),
])  # fmt: skip
def test_a_bad_cell_is_named(tmp_path, text, message):
    with pytest.raises(InvalidInput) as caught:
        shots(IMAGES, table(tmp_path, text))
    assert message in str(caught.value)
    assert "forces.csv" in str(caught.value)
