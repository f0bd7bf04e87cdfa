"""A file or a folder is written whole or not at all, and nothing of others is replaced."""

import os

import pytest

import metafem as mf
from metafem.files import check_free, refuse_existing, write_text
from metafem.files.atomic import (
    LOCK,
    MANIFEST,
    MARKS,
    WORK,
    digest,
    earlier_result,
    staged,
    write_file,
    written,
)
from metafem.progress import listening


def put(target, force=False, contents=None, **texts):
    """Write texts into a folder under the names NAME.txt."""
    with staged(target, force, contents or {}) as fresh:
        for name, text in texts.items():
            (fresh / f"{name}.txt").write_text(text)


def failing(folder, error):
    """Write a file into a folder, and fail."""
    (folder / "a.txt").write_text("2")
    raise error


def disturbed(folder, path):
    """Write a file into a folder while another program writes its own."""
    (folder / "a.txt").write_text("2")
    path.parent.mkdir(exist_ok=True)
    path.write_text("theirs")


def everything(folder):
    return {str(path.relative_to(folder)): path.is_dir() or path.read_bytes() for path in folder.rglob("*")}


def texts(folder):
    return {path.stem: path.read_text() for path in folder.iterdir() if path.name != MANIFEST}


@pytest.fixture
def target(tmp_path):
    """A result folder with the texts a and b, which are 1."""
    put(tmp_path / "out", a="1", b="1")
    return tmp_path / "out"


def test_a_folder_appears_whole_or_not_at_all(tmp_path, target):
    with staged(tmp_path / "new") as fresh:
        (fresh / "a.txt").write_text("a")
        assert not (tmp_path / "new").exists()
        assert fresh.parent == tmp_path
    assert texts(tmp_path / "new") == {"a": "a"}
    before = everything(tmp_path)
    for name, error in (("out", ValueError), ("next", KeyboardInterrupt)):
        with pytest.raises(error), staged(tmp_path / name, True) as fresh:
            failing(fresh, error)
    assert everything(tmp_path) == before


def test_force_replaces_a_result_folder_and_follows_a_link(tmp_path, target):
    (tmp_path / "link").symlink_to(target)
    (tmp_path / "empty").mkdir()
    put(tmp_path / "link", True, a="2")
    put(tmp_path / "empty", a="3")
    assert (texts(target), texts(tmp_path / "empty")) == ({"a": "2"}, {"a": "3"})
    assert written(target) == {"a.txt": {digest(target / "a.txt")}}
    (target / "a.txt").write_text("4")
    put(target, True, {"a.txt": b"4"}, a="4")  # changed to the content that is written
    assert {path.name for path in tmp_path.iterdir()} == {"out", "link", "empty"}


def test_nothing_of_others_is_replaced(tmp_path, target):
    (tmp_path / "file").write_text("mine")
    for name, force, change, words in (
        ("out", False, "", "out exists; choose another folder, or replace it with force=True"),
        ("file", True, "", "file is in the way and is not a folder"),
        ("x" * 300, True, "", "File name too long"),
        ("none/out", True, "", "none is not a folder"), ("out", True, "out.old", "out.old exists"),
        ("out", True, "out/c.txt", "c.txt was not written by metafem"),
        ("out", True, "out/a.txt", "a.txt was changed since metafem wrote it"),
        ("out", False, "out/a.txt", "a.txt was changed since metafem wrote it"),
    ):  # fmt: skip
        if change:
            (tmp_path / change).write_text("2")
        before = everything(tmp_path)
        for call in (check_free, put):
            with pytest.raises(mf.InvalidInput) as error:
                call(tmp_path / name, force)
            assert words in str(error.value)
        assert everything(tmp_path) == before
        if change and change != "out/a.txt":
            (tmp_path / change).unlink()


def test_what_another_program_made_in_the_meantime_stays(tmp_path, target):
    for name, path, words in (
        ("out", "out/a.txt", "a.txt was changed"), ("out", "out/c.txt", "c.txt was not written"),
        ("new", "new/a.txt", "was made by another program"),
    ):  # fmt: skip
        before = everything(tmp_path)
        with pytest.raises(mf.InvalidInput, match=words), staged(tmp_path / name, True) as fresh:
            disturbed(fresh, tmp_path / path)
        assert everything(tmp_path) == {**before, name: True, path: b"theirs"}
        (tmp_path / path).unlink()
        (target / "a.txt").write_text("1")


def test_two_runs_do_not_write_to_one_place(tmp_path, target):
    with staged(target, True) as fresh:
        (fresh / "a.txt").write_text("2")
        for second in (lambda: put(target, True, a="3"), lambda: write_text(target / "c.txt", "3")):
            with pytest.raises(mf.InvalidInput, match="out is being written by another run"):
                second()
        put(tmp_path / "other", a="3")  # and the folder of a living run is not removed
    assert texts(target) == {"a": "2"}


def test_remains_of_a_killed_run_are_named_and_removed(tmp_path, target):
    target.rename(tmp_path / "out.old")
    (tmp_path / f".x{LOCK}").touch()
    (tmp_path / f".x{WORK}").mkdir()
    (tmp_path / f".out{WORK}").mkdir()
    assert earlier_result(target) == tmp_path / "out.old"
    facts = []
    with listening(lambda *_: None, facts.append):
        put(target, a="2")
    assert [fact.partition(" is an")[0] for fact in facts] == [str(tmp_path / "out.old")]
    assert earlier_result(target) is None
    assert {path.name for path in tmp_path.iterdir()} == {"out", "out.old"}


def test_only_force_replaces_a_file_and_only_one_that_metafem_wrote(tmp_path, target):
    path = tmp_path / "a.txt"
    write_text(path, "µ\n")
    assert path.read_bytes() == "µ\n".encode()
    with pytest.raises(mf.InvalidInput, match=r"a\.txt exists; choose another name, or .* force=True"):
        write_text(path, "new")
    with pytest.raises(mf.InvalidInput, match=r"a\.txt exists; replace it with"):
        refuse_existing(path, False, fixed=True)
    write_text(path, "new", force=True)
    with pytest.raises(mf.InvalidInput, match=r"a\.txt was not written by metafem"):
        write_text(path, "newer", force=True, kind="figure")
    assert path.read_text() == "new"
    path.write_bytes(b"x" * (200 - len(MARKS["figure"])) + MARKS["figure"])
    write_text(path, "newest", force=True, kind="figure")
    (target / "c.txt").write_text("mine")
    for name, words in (("c", "was not written by metafem"), ("a", "was changed since metafem wrote it")):
        (target / "a.txt").write_text("2")
        with pytest.raises(mf.InvalidInput, match=rf"{name}\.txt {words}"):
            write_text(target / f"{name}.txt", "3", force=True)
    write_text(target / "b.txt", "2", force=True)
    write_text(target / "d.txt", "2")
    hashes = written(target)
    assert (hashes.keys(), len(hashes["b.txt"])) == ({"a.txt", "b.txt", "d.txt"}, 2)
    assert digest(target / "d.txt") in hashes["d.txt"]


def test_a_file_that_cannot_be_written_leaves_nothing(tmp_path, target):
    (tmp_path / "link").symlink_to(tmp_path / "c")
    os.mkfifo(tmp_path / "pipe")
    before = {path.name for path in tmp_path.iterdir()}
    for name, words in (
        ("none/a", "No such file"), ("x" * 300, "File name"), ("out", "it is a folder"),
        ("link", "it is a link"), ("pipe", "it is no regular file"),
    ):  # fmt: skip
        with pytest.raises(mf.InvalidInput, match=f"cannot be written: {words}"):
            write_text(tmp_path / name, "text", force=True)

    def outdated():
        raise mf.InvalidInput("replaced")

    def race(fresh):
        fresh.write_text("new")
        (tmp_path / "b").write_text("theirs")

    with pytest.raises(mf.InvalidInput, match="replaced"):
        write_text(tmp_path / "b", "text", still=outdated)
    with pytest.raises(mf.InvalidInput, match="b exists"):
        write_file(tmp_path / "b", race)
    assert (tmp_path / "b").read_text() == "theirs"
    assert {path.name for path in tmp_path.iterdir()} == before | {"b"}
