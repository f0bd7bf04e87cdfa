import os
from pathlib import Path

import pytest

import metafem as mf
from metafem.files.atomic.manifest import MANIFEST, digest, written
from metafem.files.atomic.staged import staged
from metafem.files.atomic.text import refuse_existing, write_file, write_text


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


def test_force_replaces_only_content_that_is_known(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("mine")
    for call in (
        lambda: refuse_existing(path, True, lambda content: content == b"ours"),
        lambda: write_text(path, "new", force=True, ours=lambda content: content == b"ours"),
    ):
        with pytest.raises(mf.InvalidInput, match=r"a\.txt was not written by metafem"):
            call()
    assert path.read_text() == "mine"
    path.write_text("ours")
    write_text(path, "new", force=True, ours=lambda content: content == b"ours")
    assert path.read_text() == "new"


@pytest.mark.parametrize("force", [False, True])
def test_a_file_made_in_the_meantime_stays(tmp_path, force):
    path = tmp_path / "a.txt"

    def write(fresh):
        fresh.write_text("new")
        path.write_text("theirs")

    with pytest.raises(mf.InvalidInput, match=r"exists|was not written by metafem"):
        write_file(path, write, force=force, ours=lambda content: content == b"ours")
    assert path.read_text() == "theirs"
    assert [each.name for each in tmp_path.iterdir()] == ["a.txt"]


@pytest.mark.parametrize("kind", ["device", "pipe", "link", "dangling link"])
def test_force_replaces_no_device_pipe_or_link(tmp_path, kind):
    path, other = tmp_path / "a.txt", tmp_path / "b.txt"
    if kind == "device":
        path = Path("/dev/full")
        if not path.exists():
            pytest.skip("this system has no /dev/full")
    elif kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to(other)
        if kind == "link":
            other.write_text("mine")
    before = os.lstat(path).st_mode
    with pytest.raises(mf.InvalidInput, match="cannot be written: it is"):
        write_text(path, "text", force=True)
    assert os.lstat(path).st_mode == before
    assert not other.exists() or other.read_text() == "mine"


def test_a_full_disk_leaves_the_old_file_and_nothing_else(tmp_path):
    resource = pytest.importorskip("resource")
    path = tmp_path / "a.txt"
    write_text(path, "old")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, hard))
    try:
        with pytest.raises(mf.InvalidInput, match=r"a\.txt cannot be written: File too large"):
            write_text(path, 5000 * "x", force=True)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert path.read_text() == "old"
    assert [each.name for each in tmp_path.iterdir()] == ["a.txt"]


def result(tmp_path):
    with staged(tmp_path / "out") as fresh:
        (fresh / "law.csv").write_text("1")
    return tmp_path / "out"


def test_a_file_of_a_result_folder_is_known_by_the_manifest(tmp_path):
    folder = result(tmp_path)
    write_text(folder / "report.html", "1")
    write_text(folder / "report.html", "2", force=True)
    assert written(folder) == {name: {digest(folder / name)} for name in ("law.csv", "report.html")}
    (folder / "report.html").write_text("2, and a remark")
    with pytest.raises(mf.InvalidInput, match=r"report\.html was changed since metafem wrote it"):
        write_text(folder / "report.html", "3", force=True)
    (folder / "study.nc").write_text("mine")
    with pytest.raises(mf.InvalidInput, match=r"study\.nc was not written by metafem"):
        write_text(folder / "study.nc", "3", force=True)
    assert sorted(path.name for path in folder.iterdir()) == [MANIFEST, "law.csv", "report.html", "study.nc"]
    (folder / "report.html").rename(folder / "mine.html")
    with staged(folder, True) as fresh:
        (fresh / "law.csv").write_text("4")
    assert sorted(path.name for path in folder.iterdir()) == [MANIFEST, "law.csv", "mine.html", "study.nc"]


def test_outdated_text_is_not_written(tmp_path):
    def still():
        raise mf.InvalidInput("replaced")

    with pytest.raises(mf.InvalidInput, match="replaced"):
        write_text(tmp_path / "a.txt", "text", still=still)
    assert list(tmp_path.iterdir()) == []


def test_a_manifest_that_was_cut_short_is_read_as_far_as_it_goes(tmp_path):
    folder = result(tmp_path)
    with (folder / MANIFEST).open("a") as file:
        file.write("0123\nnothing\n" + "0" * 64 + "  b.txt\n")
    assert written(folder) == {"law.csv": {digest(folder / "law.csv")}, "b.txt": {"0" * 64}}
