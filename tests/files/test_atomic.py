import contextlib
import os
from pathlib import Path

import pytest

import metafem as mf
from metafem.files import atomic
from metafem.files.atomic import (
    LOCK,
    MANIFEST,
    WORK,
    check_free,
    digest,
    earlier_result,
    refuse_existing,
    staged,
    write_file,
    write_text,
    written,
)
from metafem.progress import listening


def put(target, force=False, **texts):
    """Write texts into a folder under the names NAME.txt."""
    with staged(target, force) as fresh:
        for name, text in texts.items():
            (fresh / f"{name}.txt").write_text(text)


def texts(folder):
    """Texts of the files in a folder that are not hidden."""
    return {path.stem: path.read_text() for path in folder.iterdir() if not path.name.startswith(".")}


def test_the_folder_appears_when_the_body_ends(tmp_path):
    target = tmp_path / "out"
    with staged(target) as fresh:
        (fresh / "a.txt").write_text("a")
        assert not target.exists()
    assert (target / "a.txt").read_text() == "a"
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_a_failing_body_leaves_nothing(tmp_path, error):
    def failing(folder):
        (folder / "a.txt").write_text("a")
        raise error

    with pytest.raises(error), staged(tmp_path / "out") as fresh:
        failing(fresh)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("force", [False, True])
def test_force_is_offered_only_where_it_replaces(tmp_path, force):
    (tmp_path / "out").mkdir()
    for name in ("a.txt", "b.txt", "c.txt", "d.txt"):
        (tmp_path / "out" / name).touch()
    with pytest.raises(mf.InvalidInput, match=r"out/a\.txt \(and 3 more\) was not written") as error:
        check_free(tmp_path / "out", force)
    assert "force=True" not in str(error.value)


@pytest.mark.parametrize("force", [False, True])
def test_a_link_to_a_folder_stands_for_it(tmp_path, force):
    (tmp_path / "out").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "out")
    put(tmp_path / "link", force, a="1")
    assert texts(tmp_path / "out") == {"a": "1"}
    put(tmp_path / "link", True, a="2")
    assert texts(tmp_path / "out") == {"a": "2"}
    assert (tmp_path / "link").is_symlink()


@pytest.mark.parametrize(("content", "force"), [(None, False), (None, True), ("1", True)])
def test_an_empty_or_by_force_a_result_folder_is_used(tmp_path, content, force):
    target = tmp_path / "out"
    if content:
        put(target, a=content)
    else:
        target.mkdir()
    with staged(target, force=force) as fresh:
        (fresh / "new.txt").write_text("new")
    assert sorted(path.name for path in target.iterdir()) == [MANIFEST, "new.txt"]
    assert list(tmp_path.iterdir()) == [target]


def test_a_failing_body_spares_the_replaced_folder(tmp_path):
    target = tmp_path / "out"
    put(target, a="1")
    with pytest.raises(ValueError, match="stop"), staged(target, force=True):
        raise ValueError("stop")
    assert texts(target) == {"a": "1"}
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("mine", r"^\S*mine exists; choose another folder, or replace it with force=True"),
        ("file", "file is in the way and is not a folder"),
        ("none/out", "none is not a folder"),
        ("file/out", "file is not a folder"),
        ("x" * 300, "cannot be written: File name too long"),
        ("new", "cannot be written: File exists"),
    ],
)
def test_a_folder_that_cannot_be_written_is_refused(tmp_path, name, words):
    put(tmp_path / "mine", design="1")
    (tmp_path / "file").write_text("mine")
    (tmp_path / f".new{WORK}").symlink_to(tmp_path / "mine")
    before = everything(tmp_path)
    with pytest.raises(mf.InvalidInput, match=words):
        put(tmp_path / name, force=name != "mine")
    assert everything(tmp_path) == before


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("content", [None, "theirs"])
def test_a_folder_made_in_the_meantime_stays(tmp_path, content, force):
    target = tmp_path / "out"

    def another_process(fresh):
        (fresh / "a.txt").write_text("a")
        target.mkdir()
        if content:
            (target / "a.txt").write_text(content)

    with pytest.raises(mf.InvalidInput, match="made by another program"), staged(target, force) as fresh:
        another_process(fresh)
    assert texts(target) == ({"a": content} if content else {})
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_force_refuses_a_folder_with_something_of_others_and_leaves_it(tmp_path, kind):
    target = tmp_path / "out"
    put(target, a="1")
    if kind == "file":
        (target / "notes.txt").write_text("mine")
    else:
        (target / "notes.txt").mkdir()
    before = everything(tmp_path)
    with (
        pytest.raises(mf.InvalidInput, match=r"notes\.txt was not written by metafem"),
        staged(target, True),
    ):
        pytest.fail("the body ran")
    assert everything(tmp_path) == before


@pytest.mark.parametrize("change", ["changed", "link"])
def test_a_changed_file_is_refused_before_the_work(tmp_path, change):
    target = tmp_path / "out"
    put(target, a="1", b="1")
    if change == "link":
        (target / "b.txt").rename(tmp_path / "b.txt")
        (target / "b.txt").symlink_to(tmp_path / "b.txt")
    else:
        (target / "b.txt").write_text("1, and a remark")
    before = texts(target)
    with (
        pytest.raises(mf.InvalidInput, match=r"b\.txt was changed since metafem wrote it"),
        staged(target, True),
    ):
        pytest.fail("the body ran")
    assert texts(target) == before


def test_a_changed_file_with_the_new_content_is_no_obstacle(tmp_path):
    target = tmp_path / "out"
    put(target, a="1")
    (target / "a.txt").write_text("2")
    with staged(target, True, {"a.txt": b"2"}) as fresh:
        (fresh / "a.txt").write_text("2")
    put(target, True, a="3")
    assert texts(target) == {"a": "3"}


@pytest.mark.parametrize("name", ["a", "new"])
def test_a_file_changed_or_made_during_the_work_stays_and_so_do_all(tmp_path, name):
    target = tmp_path / "out"
    put(target, a="1", b="1")

    def another_process(fresh):
        for each in ("a", "b", "new"):
            (fresh / f"{each}.txt").write_text("2")
        (target / f"{name}.txt").write_text("theirs")

    with pytest.raises(mf.InvalidInput, match=f"out/{name}.txt was"), staged(target, True) as fresh:
        another_process(fresh)
    assert texts(target) == {"a": "1", "b": "1", name: "theirs"}
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("exists", [False, True])
def test_a_second_writer_is_refused(tmp_path, exists):
    target = tmp_path / "out"
    if exists:
        put(target, a="0")
    with staged(target, exists) as fresh:
        (fresh / "a.txt").write_text("1")
        with pytest.raises(mf.InvalidInput, match="being written by another run"):
            put(target, exists, a="2")
        if exists:
            with pytest.raises(mf.InvalidInput, match="being written by another run"):
                write_text(target / "b.txt", "2")
    assert texts(target) == {"a": "1"}


class Killed(BaseException):
    """Stands for the end of the process."""


@pytest.fixture
def finished(monkeypatch):
    """Whether a work ends before its n-th change of a name, at which the process is killed.

    The system then frees the locks, and nothing is tidied.
    """

    def after(n, work):
        count = iter(range(n))

        def counted(change):
            def call(*arguments, **options):
                if next(count, None) is None:
                    raise Killed
                return change(*arguments, **options)

            return call

        with monkeypatch.context() as patch:
            patch.setattr(atomic, "_remove", lambda _: None)
            for name in ("replace", "mkdir", "unlink", "rename"):
                patch.setattr(Path, name, counted(getattr(Path, name)))
            with contextlib.suppress(Killed):
                work()
                return True
        return False

    return after


def everything(folder):
    return {str(path.relative_to(folder)): path.is_dir() or path.read_bytes() for path in folder.rglob("*")}


def hidden(folder):
    return [path for path in folder.rglob("*") if path.name.endswith((LOCK, WORK))]


def test_a_killed_run_leaves_at_worst_the_whole_earlier_folder_and_the_next_run_says_so(tmp_path, finished):
    left = []
    for n in range(40):
        target = tmp_path / f"{n}" / "out"
        old = target.with_name("out.old")
        target.parent.mkdir()
        put(target, a="1", stale="1")
        before = everything(target)
        ended = finished(n, lambda target=target: put(target, True, a="2", b="2"))
        left.append((target.exists(), old.exists()))
        assert not target.exists() or everything(target) == before or texts(target) == {"a": "2", "b": "2"}
        assert not old.exists() or everything(old) == before
        if ended:
            break
        said = []
        if target.exists() and old.exists():
            with pytest.raises(mf.InvalidInput, match=r"out\.old exists: a run that was stopped"):
                put(target, True, a="3")
        else:
            assert earlier_result(target) == (old if old.exists() else None)
            with listening(lambda *_: None, said.append):
                put(target, True, a="3")
            assert texts(target) == {"a": "3"}
        assert not old.exists() or everything(old) == before
        assert ("a run was stopped" in "".join(said)) == (left[-1] == (False, True))
        assert not hidden(target.parent)
    assert set(left) == {(True, False), (False, True), (True, True)}
    assert left[-1] == (True, False)


def test_a_run_killed_while_it_made_a_folder_leaves_nothing_after_the_next(tmp_path, finished):
    for n in range(40):
        ended = finished(n, lambda: put(tmp_path / "out", a="1"))
        put(tmp_path / f"next{n}", b="1")
        assert {path.name for path in tmp_path.iterdir()} - {f"next{i}" for i in range(40)} <= {"out"}
        if ended:
            break
    assert texts(tmp_path / "out") == {"a": "1"}


def test_a_run_killed_while_it_wrote_a_file_leaves_the_old_one_or_the_new(tmp_path, finished):
    target = tmp_path / "out"
    for n in range(40):
        put(target, target.exists(), a="1")
        ended = finished(n, lambda: write_text(target / "a.txt", "2", force=True))
        assert texts(target) == {"a": "2" if ended else "1"}
        if ended:
            break
        write_text(target / "a.txt", "3", force=True)
        assert texts(target) == {"a": "3"}
        assert not hidden(tmp_path)
    assert n > 1


def test_an_error_while_a_folder_is_replaced_leaves_the_old_one(tmp_path, monkeypatch):
    target = tmp_path / "out"
    put(target, a="1", b="1", stale="1")
    before = everything(tmp_path)
    move = Path.rename

    def refused(path, goal):
        if path.name.endswith(WORK):
            raise PermissionError(13, "Permission denied")
        return move(path, goal)

    with monkeypatch.context() as patch:
        patch.setattr(Path, "rename", refused)
        with pytest.raises(mf.InvalidInput, match=r"out cannot be written: Permission denied"):
            put(target, True, a="2", b="2", c="2")
    assert everything(tmp_path) == before


def test_the_folder_of_a_living_run_is_not_swept(tmp_path):
    with staged(tmp_path / "first") as fresh:
        (fresh / "a.txt").write_text("1")
        put(tmp_path / "second", a="2")
        assert (fresh / "a.txt").read_text() == "1"
    assert {path.name for path in tmp_path.iterdir()} == {"first", "second"}


@pytest.mark.parametrize("n", range(8))
def test_a_signal_while_the_working_folder_is_removed_leaves_nothing(tmp_path, monkeypatch, n):
    count = iter(range(n))

    def once(change):
        def call(*arguments, **options):
            if next(count, None) is None and not stopped:
                stopped.append(True)
                raise KeyboardInterrupt
            return change(*arguments, **options)

        return call

    stopped = []
    with contextlib.suppress(KeyboardInterrupt), staged(tmp_path / "out") as fresh:
        (fresh / "a.txt").write_text("1")
        for owner, name in ((os, "unlink"), (os, "rmdir"), (os, "close"), (Path, "unlink"), (Path, "rmdir")):
            monkeypatch.setattr(owner, name, once(getattr(owner, name)))
    monkeypatch.undo()
    assert {path.name for path in tmp_path.iterdir()} <= {"out"}


def test_only_force_replaces_a_text(tmp_path):
    write_text(tmp_path / "a.txt", "µ\n")
    assert (tmp_path / "a.txt").read_bytes() == "µ\n".encode()
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]
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
        lambda: refuse_existing(path, True, "figure"),
        lambda: write_text(path, "new", force=True, kind="figure"),
    ):
        with pytest.raises(mf.InvalidInput, match=r"a\.txt was not written by metafem"):
            call()
    assert path.read_text() == "mine"
    path.write_text("a figure by metafem")
    write_text(path, "new", force=True, kind="figure")
    assert path.read_text() == "new"


@pytest.mark.parametrize("force", [False, True])
def test_a_file_made_in_the_meantime_stays(tmp_path, force):
    path = tmp_path / "a.txt"

    def write(fresh):
        fresh.write_text("new")
        path.write_text("theirs")

    with pytest.raises(mf.InvalidInput, match=r"exists|was not written by metafem"):
        write_file(path, write, force=force, kind="figure")
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
    assert written(folder).keys() == {"law.csv", "report.html"}
    assert all(digest(folder / name) in hashes for name, hashes in written(folder).items())
    (folder / "report.html").write_text("2, and a remark")
    with pytest.raises(mf.InvalidInput, match=r"report\.html was changed since metafem wrote it"):
        write_text(folder / "report.html", "3", force=True)
    (folder / "study.nc").write_text("mine")
    with pytest.raises(mf.InvalidInput, match=r"study\.nc was not written by metafem"):
        write_text(folder / "study.nc", "3", force=True)
    assert sorted(path.name for path in folder.iterdir()) == [MANIFEST, "law.csv", "report.html", "study.nc"]
    (folder / "report.html").rename(tmp_path / "mine.html")
    (folder / "study.nc").unlink()
    with staged(folder, True) as fresh:
        (fresh / "law.csv").write_text("4")
    assert sorted(path.name for path in folder.iterdir()) == [MANIFEST, "law.csv"]


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
