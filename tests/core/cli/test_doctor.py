"""`metafem doctor`: what is installed, where caches are, and how they are removed."""

import json
from pathlib import Path

import pytest

import metafem
from metafem import _caches
from metafem.cli import doctor


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv(_caches.VARIABLE, str(tmp_path / "caches"))
    return tmp_path / "caches"


class Installed:
    """Metadata of an installation."""

    version = "1.2.3"

    def __init__(self, folder, origin=None):
        self.folder, self.origin = Path(folder), origin

    def locate_file(self, name):
        return self.folder / name

    def read_text(self, name):
        return self.origin and json.dumps(self.origin)


def test_all_stated_packages_are_needed(monkeypatch):
    stated = ["numpy>=2.1", "scikit-fem >=11", "h5py", 'tamaas>=2.9; extra == "peers"']
    monkeypatch.setattr(doctor, "requires", lambda _: stated)
    assert doctor.needed() == ["numpy", "scikit-fem", "h5py"]


def test_the_imported_package_is_the_one_installed(tmp_path, monkeypatch):
    here = Path(metafem.__file__).parents[1]
    editable = {"url": here.as_uri(), "dir_info": {"editable": True}}
    for installed, well in (
        (Installed(here), True),
        (Installed(tmp_path), False),
        (Installed(tmp_path, editable), True),
    ):
        monkeypatch.setattr(doctor, "distribution", lambda _, installed=installed: installed)
        assert doctor._package()[1] is well
    assert "1.2.3, imported from" in doctor._package()[0]


def test_a_cache_that_cannot_be_written_is_reported(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv(_caches.VARIABLE, str(tmp_path / "file"))
    found, well = doctor._cache()
    assert not well
    assert _caches.VARIABLE in found


def test_clearing_reports_how_much_was_freed(run, folder):
    (folder / "kernels" / ("a" * 32)).mkdir(parents=True)
    (folder / "kernels" / ("a" * 32) / "kernel").write_bytes(b"x" * 250_000)
    (folder / "block-1.npz").write_bytes(b"x" * 100_000)
    (folder / "mine").touch()
    removed, left = (run("doctor", "--clear-cache", "--json").data for _ in range(2))
    sizes = ("kernels_bytes", "blocks_bytes", "left_bytes")
    assert removed == {"folder": str(folder), **dict(zip(sizes, (250_000, 100_000, 0), strict=True))}
    assert left == {"folder": str(folder), **dict.fromkeys(sizes, 0)}
    assert sorted(path.name for path in folder.rglob("*")) == ["kernels", "mine"]
