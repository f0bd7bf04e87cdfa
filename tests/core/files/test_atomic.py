"""A file or a folder is written whole or not at all, and nothing of others is replaced."""

import os

import pytest

import metafem as mf
from metafem.files import refuse_existing, staged, write_text


def put(target, force=False, **texts):
    """Write texts into a folder under the names NAME.txt, beside the file of a design."""
    with staged(target, force, folder=True) as fresh:
        for name, text in {**texts, "design": "{}"}.items():
            (fresh / f"{name}.{'json' if name == 'design' else 'txt'}").write_text(text)


def failing(folder, error):
    (folder / "a.txt").write_text("2")
    raise error


def disturbed(path, fresh):
    """Write a folder or a file while another program writes its own."""
    if fresh.is_dir():
        put(path, a="theirs")
        (fresh / "a.txt").write_text("2")
    else:
        path.write_text("theirs")
        fresh.write_text("2")


def everything(folder):
    return {str(path.relative_to(folder)): path.is_dir() or path.read_bytes() for path in folder.rglob("*")}


def texts(folder):
    return {path.stem: path.read_text() for path in folder.glob("*.txt")}


@pytest.fixture
def target(tmp_path):
    """A result folder with the texts a and b, which are 1."""
    put(tmp_path / "out", a="1", b="1")
    return tmp_path / "out"


def test_a_folder_appears_whole_or_not_at_all(tmp_path, target):
    with staged(tmp_path / "new", folder=True) as fresh:
        (fresh / "a.txt").write_text("a")
        assert not (tmp_path / "new").exists()
        assert fresh.parent.parent == tmp_path
    assert texts(tmp_path / "new") == {"a": "a"}
    before = everything(tmp_path)
    for name, error in (("out", ValueError), ("next", KeyboardInterrupt)):
        with pytest.raises(error), staged(tmp_path / name, True, folder=True) as fresh:
            failing(fresh, error)
    assert everything(tmp_path) == before


def test_force_replaces_a_result_folder_and_follows_a_link(tmp_path, target):
    (tmp_path / "link").symlink_to(target)
    (tmp_path / "empty").mkdir()
    put(tmp_path / "link", True, a="2")
    put(tmp_path / "empty", a="3")
    assert (texts(target), texts(tmp_path / "empty")) == ({"a": "2"}, {"a": "3"})
    assert {path.name for path in tmp_path.iterdir()} == {"out", "link", "empty"}


def test_nothing_of_others_is_replaced(tmp_path, target):
    (tmp_path / "file").write_text("mine")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "mine").touch()
    os.mkfifo(tmp_path / "pipe")
    before = sorted(tmp_path.rglob("*"))
    for name, force, folder, words in (
        ("out", False, True, "out exists; choose another name, or replace it with force=True"),
        ("file", False, False, "file exists; choose another name, or replace it with force=True"),
        ("file", True, True, "is no result folder"), ("folder", True, True, "is no result folder"),
        ("out", True, False, "is no regular file"), ("pipe", True, False, "is no regular file"),
        ("none/out", True, True, "none is not a folder"), ("none/a", True, False, "none is not a folder"),
        ("x" * 300, True, True, "File name too long"),
    ):  # fmt: skip
        for call in (refuse_existing, lambda *given, folder: staged(*given, folder=folder).__enter__()):
            with pytest.raises(mf.InvalidInput) as error:
                call(tmp_path / name, force, folder=folder)
            assert words in str(error.value)
        assert sorted(tmp_path.rglob("*")) == before
    assert (tmp_path / "file").read_text() == "mine"


def test_what_another_program_made_in_the_meantime_stays(tmp_path):
    for name, folder in (("new", True), ("b", False)):
        with pytest.raises(mf.InvalidInput, match="exists"), staged(tmp_path / name, folder=folder) as fresh:
            disturbed(tmp_path / name, fresh)
    assert texts(tmp_path / "new") == {"a": "theirs"}
    assert (tmp_path / "b").read_text() == "theirs"
    assert {path.name for path in tmp_path.iterdir()} == {"new", "b"}


def test_a_full_disk_leaves_the_old_file_and_nothing_else(tmp_path):
    resource = pytest.importorskip("resource")
    path = tmp_path / "a.txt"
    write_text(path, "µ")
    assert path.read_bytes() == "µ".encode()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, hard))
    try:
        with pytest.raises(mf.InvalidInput, match=r"a\.txt cannot be written: File too large"):
            write_text(path, 5000 * "x", force=True)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert path.read_text() == "µ"
    write_text(path, "new", force=True)
    assert path.read_text() == "new"
    assert [each.name for each in tmp_path.iterdir()] == ["a.txt"]
