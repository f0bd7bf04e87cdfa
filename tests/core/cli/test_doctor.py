"""`metafem doctor`: what is installed, and where caches are."""

from importlib import import_module

from metafem import _caches


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
