"""`metafem doctor`: what is installed, where caches are, and how they are removed."""

from importlib import import_module

import pytest

from metafem import _caches


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv(_caches.VARIABLE, str(tmp_path / "caches"))
    return tmp_path / "caches"


def test_an_installation_has_no_fault(run):
    assert all(finding["well"] for finding in run("doctor", "--json").data)


def test_a_cache_that_cannot_be_written_is_reported(run, tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv(_caches.VARIABLE, str(tmp_path / "file"))
    doctor = import_module("metafem.cli.doctor")
    monkeypatch.setattr(doctor, "CHECKS", {"cache": doctor._cache})
    (finding,) = run("doctor", "--json").missed
    assert not finding["well"]
    assert "FileExistsError" in finding["found"]


def test_clearing_reports_how_much_was_freed(run, folder):
    (folder / "kernels" / ("a" * 32)).mkdir(parents=True)
    (folder / "kernels" / ("a" * 32) / "kernel").write_bytes(b"x" * 250_000)
    (folder / "block-1.npz").write_bytes(b"x" * 100_000)
    (folder / "mine").touch()
    removed, left = (run("doctor", "--clear-cache", "--json").data for _ in range(2))
    assert removed == {"folder": str(folder), "freed_bytes": 350_000, "left_bytes": 0}
    assert left == {"folder": str(folder), "freed_bytes": 0, "left_bytes": 0}
    assert sorted(path.name for path in folder.rglob("*")) == ["kernels", "mine"]
