"""Compiled kernels outlive the process, outside the package, and never their sources."""

import os
import shutil
from pathlib import Path

import pytest
from numba.core import event

import metafem
from metafem import _caches
from metafem._kernels import compiled as module
from metafem._kernels.compiled import compiled, on_first_compilation, version

KERNELS = Path(metafem.__file__).parent / "_kernels"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv(_caches.VARIABLE, str(tmp_path))
    return tmp_path


def twice(x):
    return 2.0 * x


def compilations(call):
    """Return how often `call` has numba compile."""
    with event.install_recorder("numba:compile") as recorder:
        call()
    return sum(1 for _, each in recorder.buffer if each.is_start)


def test_a_signature_is_compiled_once_for_all_processes(folder):
    assert compilations(lambda: compiled(twice)(1.0)) == 1
    assert compilations(lambda: compiled(twice)(1.0)) == 0
    assert compilations(lambda: compiled(twice)(1)) == 1
    assert compiled(twice)(3.0) == 6.0
    (version_folder,) = (folder / "kernels").iterdir()
    assert len(list(version_folder.iterdir())) == 2


def test_the_first_compilation_of_a_process_is_announced_once(folder):
    told = []
    on_first_compilation(lambda: told.append(1))
    for value in (1.0, 1, True):
        compiled(twice)(value)
    assert told == [1]


def test_a_cache_that_cannot_be_written_breaks_nothing(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv(_caches.VARIABLE, str(tmp_path / "file"))
    assert compiled(twice)(2.0) == 4.0


def test_an_interrupted_write_leaves_no_file(folder, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    assert compiled(twice)(2.0) == 4.0
    assert not [path for path in folder.rglob("*") if path.is_file()]


def test_an_edit_of_any_kernel_is_another_version(tmp_path):
    copy = shutil.copytree(KERNELS, tmp_path / "_kernels", ignore=shutil.ignore_patterns("__pycache__"))
    seen = {version(copy)}
    assert seen == {version(KERNELS)}
    for source in ("compiled.py", "vectors.py", "law.py"):
        with (copy / source).open("a") as file:
            file.write("\n")
        seen.add(version(copy))
    assert len(seen) == 4


def test_only_the_newest_versions_are_kept(folder):
    foreign = folder / "kernels" / "mine"
    foreign.mkdir(parents=True)
    for i in range(12):
        other = folder / "kernels" / f"{i:032x}"
        other.mkdir()
        (other / "kernel").write_bytes(b"x")
        os.utime(other, (i, i))
    compiled(twice)(1.0)
    kept = {path.name for path in _caches.kept_kernels()}
    assert kept == {module.folder().name, *(f"{i:032x}" for i in range(5, 12))}
    assert foreign.is_dir()
