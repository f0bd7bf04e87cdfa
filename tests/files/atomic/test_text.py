import pytest

import metafem as mf
from metafem.files.atomic.text import write_text


def test_a_text_is_written_as_utf8(tmp_path):
    write_text(tmp_path / "a.txt", "µ\n")
    assert (tmp_path / "a.txt").read_bytes() == "µ\n".encode()
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_only_force_replaces_a_text(tmp_path):
    write_text(tmp_path / "a.txt", "old")
    with pytest.raises(mf.InvalidInput, match="force=True"):
        write_text(tmp_path / "a.txt", "new")
    write_text(tmp_path / "a.txt", "new", force=True)
    assert (tmp_path / "a.txt").read_text() == "new"


@pytest.mark.parametrize("name", ["none/a.txt", "file/a.txt", "folder", "x" * 300])
def test_an_unwritable_text_leaves_nothing(tmp_path, name):
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    with pytest.raises(mf.InvalidInput, match="cannot be written"):
        write_text(tmp_path / name, "text", force=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder"]
