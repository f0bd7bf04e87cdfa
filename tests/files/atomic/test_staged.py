import contextlib
import os
from pathlib import Path

import pytest

import metafem as mf
from metafem.files.atomic import claim
from metafem.files.atomic.claim import restore
from metafem.files.atomic.manifest import FORMAT, MANIFEST
from metafem.files.atomic.replacement import undo
from metafem.files.atomic.staged import check_free, staged

OURS = f'{{"format": "{FORMAT}"}}'


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


def test_a_result_folder_is_refused_with_the_way_out(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "design.json").write_text(OURS)
    with pytest.raises(mf.InvalidInput, match="force=True"), staged(tmp_path / "out"):
        pass


@pytest.mark.parametrize("force", [False, True])
def test_force_is_offered_only_where_it_replaces(tmp_path, force):
    (tmp_path / "out").mkdir()
    for name in ("a.txt", "b.txt", "c.txt", "d.txt"):
        (tmp_path / "out" / name).touch()
    with pytest.raises(mf.InvalidInput, match=r"\(a.txt, b.txt, c.txt and 1 more\)") as error:
        check_free(tmp_path / "out", force)
    assert str(error.value).endswith("choose another folder")
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


@pytest.mark.parametrize(("content", "force"), [(None, False), (None, True), (OURS, True)])
def test_an_empty_or_by_force_a_result_folder_is_used(tmp_path, content, force):
    target = tmp_path / "out"
    target.mkdir()
    if content:
        (target / "design.json").write_text(content)
    with staged(target, force=force) as fresh:
        (fresh / "new.txt").write_text("new")
    assert sorted(path.name for path in target.iterdir()) == [MANIFEST, "new.txt"]
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("content", ["{}", '{"format"', "[]"])
def test_force_spares_foreign_folders(tmp_path, content):
    target = tmp_path / "out"
    target.mkdir()
    (target / "design.json").write_text(content)
    with pytest.raises(mf.InvalidInput, match="not replaced"), staged(target, force=True):
        pass
    assert (target / "design.json").read_text() == content


def test_a_failing_body_spares_the_replaced_folder(tmp_path):
    target = tmp_path / "out"
    target.mkdir()
    (target / "design.json").write_text(OURS)
    with pytest.raises(ValueError, match="stop"), staged(target, force=True):
        raise ValueError("stop")
    assert (target / "design.json").read_text() == OURS
    assert list(tmp_path.iterdir()) == [target]


def test_a_file_in_the_way_is_refused_even_by_force(tmp_path):
    (tmp_path / "out").write_text("mine")
    with pytest.raises(mf.InvalidInput, match="not a folder"), staged(tmp_path / "out", force=True):
        pass


@pytest.mark.parametrize("parent", ["none", "file"])
def test_a_parent_that_is_no_folder_is_refused(tmp_path, parent):
    (tmp_path / "file").write_text("")
    with pytest.raises(mf.InvalidInput, match="is not a folder"), staged(tmp_path / parent / "out"):
        pass


def test_an_unwritable_name_is_refused(tmp_path):
    with (
        pytest.raises(mf.InvalidInput, match="cannot be used: File name too long"),
        staged(tmp_path / ("x" * 300)),
    ):
        pass


def test_the_root_is_refused():
    with pytest.raises(mf.InvalidInput, match="name a new one"), staged("/"):
        pass


def test_the_error_for_an_existing_folder_suggests_another(tmp_path):
    put(tmp_path / "mine", design="1")
    with pytest.raises(mf.InvalidInput, match=r"^\S*mine exists; choose another folder"):
        check_free(tmp_path / "mine")
    with pytest.raises(mf.InvalidInput, match="is not a path"):
        check_free("a\0b")


def put(target, force=False, **texts):
    """Write texts into a folder under the names NAME.txt."""
    with staged(target, force) as fresh:
        for name, text in texts.items():
            (fresh / f"{name}.txt").write_text(text)


def texts(folder):
    """Texts of the files in a folder that are not hidden."""
    return {path.stem: path.read_text() for path in folder.iterdir() if not path.name.startswith(".")}


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


def test_force_keeps_what_others_wrote(tmp_path):
    target = tmp_path / "out"
    put(target, a="1", stale="1")
    (target / "notes.txt").write_text("mine")
    (target / "photos").mkdir()
    put(target, True, a="2", b="2")
    (target / "photos").rmdir()
    assert texts(target) == {"a": "2", "b": "2", "notes": "mine"}
    assert list(tmp_path.iterdir()) == [target]


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


def test_a_foreign_file_of_a_name_to_come_is_refused_before_the_work(tmp_path):
    target = tmp_path / "out"
    put(target, a="1")
    (target / "b.txt").write_text("mine")
    with (
        pytest.raises(mf.InvalidInput, match=r"b\.txt was not written by metafem"),
        staged(target, True, {"b.txt": None}),
    ):
        pytest.fail("the body ran")


@pytest.mark.parametrize("name", ["a", "new"])
def test_a_file_changed_or_made_during_the_work_stays_and_so_do_all(tmp_path, name):
    target = tmp_path / "out"
    put(target, a="1", b="1")

    def another_process(fresh):
        for each in ("a", "b", "new"):
            (fresh / f"{each}.txt").write_text("2")
        (target / f"{name}.txt").write_text("theirs")

    with pytest.raises(mf.InvalidInput, match=f"{name}.txt was"), staged(target, True) as fresh:
        another_process(fresh)
    assert texts(target) == {"a": "1", "b": "1", name: "theirs"}
    put(tmp_path / "other", a="1")
    assert not [path for path in target.iterdir() if path.is_dir()]


@pytest.mark.parametrize("exists", [False, True])
def test_the_error_of_a_second_writer_names_the_first(tmp_path, exists):
    target = tmp_path / "out"
    if exists:
        put(target, a="0")
    with staged(target, exists) as fresh:
        (fresh / "a.txt").write_text("1")
        if exists:
            (target / "a.txt").write_text("1")  # as while the files are being replaced
        with pytest.raises(mf.InvalidInput, match=rf"being written by another run .*process {os.getpid()} "):
            put(target, exists, a="2")
    assert texts(target) == {"a": "1"}


class Killed(BaseException):
    """Stands for the end of the process."""


@pytest.fixture
def killed(monkeypatch):
    """Let a process end at its n-th change of a file's name: the system frees its lock, nothing is tidied."""

    def after(n, error=Killed):
        count = iter(range(n))

        def counted(change):
            def call(*arguments, **options):
                if next(count, None) is None:
                    raise error
                return change(*arguments, **options)

            return call

        if error is Killed:
            monkeypatch.setattr(claim, "_released", lambda _, held: os.close(held))
        for owner, name in ((os, "link"), (Path, "replace"), (Path, "unlink"), (Path, "rename")):
            monkeypatch.setattr(owner, name, counted(getattr(owner, name)))

    return after


def everything(folder):
    return {str(path.relative_to(folder)): path.is_dir() or path.read_bytes() for path in folder.rglob("*")}


def test_a_killed_run_leaves_the_old_files_or_the_new_and_the_next_run_nothing_else(
    tmp_path, killed, monkeypatch
):
    ends = []
    for n in range(40):
        target = tmp_path / f"{n}" / "out"
        target.parent.mkdir()
        put(target, a="1", same="s", stale="1")
        (target / "notes.txt").write_text("mine")
        before = everything(target)
        killed(n)
        with contextlib.suppress(Killed):
            put(target, True, a="2", same="s", b="2")
            ends.append("finished")
        monkeypatch.undo()
        for m in range(20):  # the run that restores may be killed, too
            killed(m)
            with contextlib.suppress(Killed):
                undo(target / claim.SUFFIX, target)
            monkeypatch.undo()
        restore(target)
        if ends:
            assert texts(target) == {"a": "2", "b": "2", "same": "s", "notes": "mine"}
            break
        assert everything(target) == before
        put(target, True, a="3")
        assert everything(target.parent).keys() == {"out", "out/notes.txt", "out/a.txt", f"out/{MANIFEST}"}
    assert n > 10


def test_a_run_killed_while_it_made_a_folder_leaves_nothing_after_the_next(tmp_path, killed, monkeypatch):
    for n in range(40):
        killed(n)
        finished = False
        with contextlib.suppress(Killed):
            put(tmp_path / "out", a="1")
            finished = True
        monkeypatch.undo()
        put(tmp_path / f"next{n}", b="1")
        assert {path.name for path in tmp_path.iterdir()} - {f"next{i}" for i in range(40)} <= {"out"}
        if finished:
            break
    assert texts(tmp_path / "out") == {"a": "1"}


def test_an_error_while_files_are_replaced_leaves_the_old_ones(tmp_path, killed, monkeypatch):
    target = tmp_path / "out"
    put(target, a="1", b="1", stale="1")
    before = everything(target)
    for n in range(40):
        killed(n, PermissionError(13, "Permission denied"))
        message = ""
        try:
            put(target, True, a="2", b="2", c="2")
        except mf.InvalidInput as error:
            message = str(error)
        monkeypatch.undo()
        if not message:
            break
        assert f"{target} cannot be written: Permission denied" in message
        restore(target)
        assert everything(target) == before
    assert texts(target) == {"a": "2", "b": "2", "c": "2"}


def test_what_the_user_changed_after_a_killed_run_is_kept(tmp_path, killed, monkeypatch):
    target = tmp_path / "out"
    for n in range(40):
        put(target, True, a="1", b="1")
        killed(n)
        finished = False
        with contextlib.suppress(Killed):
            put(target, True, a="2", b="2")
            finished = True
        monkeypatch.undo()
        if finished:
            break
        (target / "a.txt").write_text("mine")
        restore(target)
        assert texts(target) == {"a": "mine", "b": "1"}
        (target / "a.txt").unlink()


def test_the_folder_of_a_living_run_is_not_swept(tmp_path):
    with staged(tmp_path / "first") as fresh:
        (fresh / "a.txt").write_text("1")
        put(tmp_path / "second", a="2")
        assert (fresh / "a.txt").read_text() == "1"
    assert {path.name for path in tmp_path.iterdir()} == {"first", "second"}


def test_a_folder_that_cannot_be_made_is_reported(tmp_path, monkeypatch):
    def refuse(path, *_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(mf.InvalidInput, match="out cannot be written: Permission denied"):
        put(tmp_path / "out")


def test_a_link_in_the_place_of_the_working_folder_is_refused(tmp_path):
    (tmp_path / "theirs" / "new").mkdir(parents=True)
    (tmp_path / ".out.metafem-writing").symlink_to(tmp_path / "theirs")
    with pytest.raises(mf.InvalidInput, match="is a link"):
        put(tmp_path / "out")
    assert (tmp_path / "theirs" / "new").exists()


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


@pytest.mark.parametrize("journal", ["", "[]", "{}", '{"added": 3, "ours": {}}'])
def test_a_damaged_journal_names_what_to_look_at(tmp_path, journal):
    work = tmp_path / ".metafem-writing"
    (work / "old").mkdir(parents=True)
    (work / "journal.json").write_text(journal)
    with pytest.raises(mf.InvalidInput, match=r"journal\.json is damaged.*old files are in .*old"):
        undo(work, tmp_path)
