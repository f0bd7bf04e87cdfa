import pytest

import metafem as mf
from metafem.files.atomic.staged import FORMAT, check_free, staged

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


def test_an_existing_folder_is_refused_with_the_way_out(tmp_path):
    (tmp_path / "out").mkdir()
    with pytest.raises(mf.InvalidInput, match="force=True"), staged(tmp_path / "out"):
        pass


@pytest.mark.parametrize("content", [None, OURS])
def test_force_replaces_an_empty_or_a_result_folder(tmp_path, content):
    target = tmp_path / "out"
    target.mkdir()
    if content:
        (target / "design.json").write_text(content)
    with staged(target, force=True) as fresh:
        (fresh / "new.txt").write_text("new")
    assert [path.name for path in target.iterdir()] == ["new.txt"]
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


def test_an_existing_folder_is_refused_in_the_words_of_its_own_error(tmp_path):
    (tmp_path / "mine").mkdir()
    with pytest.raises(mf.InvalidInput, match=r"^\S*mine exists; choose another folder"):
        check_free(tmp_path / "mine")
    with pytest.raises(mf.InvalidInput, match="is not a path"):
        check_free("a\0b")
