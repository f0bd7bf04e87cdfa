"""A process that is killed, stopped or out of disk leaves the old files or the new ones."""

import contextlib
from pathlib import Path

import pytest

import metafem as mf
from metafem.files import atomic
from metafem.files.atomic import LOCK, WORK, earlier_result, write_text
from metafem.progress import listening
from tests.core.files.test_atomic import everything, put, texts


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
