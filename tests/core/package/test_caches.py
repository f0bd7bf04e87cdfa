"""Where caches live."""

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
