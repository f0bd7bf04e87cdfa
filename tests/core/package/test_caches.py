"""Where caches live, how large they are and how they are removed."""

import pytest

from metafem import _caches


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv(_caches.VARIABLE, str(tmp_path))
    return tmp_path


def test_the_folder_is_that_of_the_variable_or_of_the_user(folder, tmp_path, monkeypatch):
    assert _caches.cache_folder() == folder
    assert _caches.kernel_folder() == folder / "kernels"
    monkeypatch.delenv(_caches.VARIABLE, raising=False)
    monkeypatch.setattr("platformdirs.user_cache_path", lambda name: tmp_path / name)
    assert _caches.cache_folder() == tmp_path / "metafem"
    monkeypatch.delenv(_caches.VARIABLE, raising=False)
    monkeypatch.setattr("platformdirs.user_cache_path", lambda name: _caches.Path("~") / name)
    with pytest.raises(OSError, match="METAFEM_CACHE_DIR"):
        _caches.cache_folder()


def test_only_what_metafem_wrote_is_removed(folder):
    (folder / "kernels" / ("a" * 32)).mkdir(parents=True)
    (folder / "kernels" / ("a" * 32) / "kernel").write_bytes(b"123")
    (folder / "block-1.npz").write_bytes(b"12345")
    (folder / "kernels" / "mine").mkdir()
    (folder / "mine.npz").write_bytes(b"1")
    assert _caches.size(_caches.kept_kernels()) == 3
    assert _caches.remove([*_caches.kept_kernels(), *_caches.kept_blocks()]) == 8
    assert sorted(path.name for path in folder.rglob("*")) == ["kernels", "mine", "mine.npz"]
    assert _caches.remove([*_caches.kept_kernels(), *_caches.kept_blocks()]) == 0
