"""What is looked at before a file is read."""

import os
from pathlib import Path

import pytest

import metafem as mf
from metafem.files import read_surface
from metafem.files.reading import TABLE, file_label, read_bytes, read_record


def read_heights(path):
    """Read a table of heights with a column of radii."""
    return read_surface(path, mf.Material(1.36))


READERS = {"spec": mf.read_spec, "table": read_heights, "record": read_record}


@pytest.mark.parametrize("read", READERS.values(), ids=READERS)
def test_what_is_not_a_file_is_refused_before_reading(tmp_path, read):
    os.mkfifo(tmp_path / "pipe")
    for path, words in (
        ("/dev/zero", "/dev/zero: cannot be read: it is a device or a pipe"),
        (tmp_path / "pipe", "it is a device or a pipe"),
        (tmp_path, "it is a folder"),
        (tmp_path / "none", "no such file"),
        (tmp_path / ("x" * 300), "File name too long"),
        ("a\0b", "is not the name of a file"),
        ("\ud800", "is not the name of a file"),
        (None, "None is not the name of a file"),
    ):
        with pytest.raises(mf.InvalidInput, match=words) as error:
            read(path)
        assert len(str(error.value).splitlines()) == 1


@pytest.mark.parametrize(("read", "size"), [(mf.read_spec, 0.25), (read_heights, 64)])
def test_a_file_that_is_too_large_is_refused(tmp_path, read, size):
    path = tmp_path / "large"
    with path.open("wb") as file:
        file.truncate(TABLE + 1)  # a hole: takes no space
    with pytest.raises(mf.InvalidInput, match=f"large: is larger than {size:g} MiB"):
        read(path)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[" * 100_000 + "]" * 100_000, "nests its values too deeply"),
        ('{"a": NaN}', "it holds NaN, which is not a number"),
        ("9" * 5000, "is damaged"),
        ("{", "is damaged: Expecting property name"),
        (b"\xff", "line 1 is not UTF-8"),
    ],
)
def test_damaged_records_are_refused(tmp_path, text, words):
    path = tmp_path / "record.json"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(mf.InvalidInput, match=words):
        read_record(path)


def test_files_are_read_whole(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"abc")
    assert read_bytes(path, 3) == b"abc"
    assert file_label(Path("a\nb")) == r"a\nb"
