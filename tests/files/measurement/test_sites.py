import numpy as np
import pytest

from metafem.errors import InvalidInput
from metafem.files.measurement.sites import read_sites


def table(tmp_path, text):
    path = tmp_path / "heights.csv"
    path.write_text(text, encoding="utf-8")
    return path


def test_sites_with_and_without_numbers(tmp_path):
    position, number = read_sites(table(tmp_path, "site,x_mm,y_um,height_mm\n7,0,1500,.1\n3,1.5,0,.1\n"))
    np.testing.assert_array_equal(position, [[0.0, 1.5], [1.5, 0.0]])
    assert number.tolist() == [7, 3]
    _, number = read_sites(table(tmp_path, "x_mm,y_mm\n0,1\n1,0\n"))
    assert number.tolist() == [0, 1]


@pytest.mark.parametrize(("text", "message"), [
    ("number,kind,site,x_mm,y_mm,depth_mm\n", "describes a mould, which is mirrored; give heights.csv"),
    ("x_mm,z_mm\n1,2\n", "lacks y_mm: it has the columns x_mm, z_mm"),
    ("x_N,y_mm\n1,2\n", "column x_N has the unit"),
    ("x_mm,x_um\n1,2\n", "x is in two columns"),
    ("x_mm,y_mm\n1,a\n", "line 2: y_mm = 'a' is not a finite number"),
    ("site,x_mm,y_mm\n1.5,1,1\n", "line 2: site = '1.5' must be a whole number"),
    ("site,x_mm,y_mm\n1,1,1\n1,2,2\n", "line 3: site = 1 is the number of another site too"),
])  # fmt: skip
def test_bad_tables(tmp_path, text, message):
    with pytest.raises(InvalidInput, match=message):
        read_sites(table(tmp_path, text))
