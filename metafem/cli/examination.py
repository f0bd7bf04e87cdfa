"""Checks of an installation, for `metafem doctor`."""

from __future__ import annotations

import json
import math
import platform
import re
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution, requires, version
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit
from urllib.request import url2pathname

import metafem
import metafem as mf
from metafem import _caches

if TYPE_CHECKING:
    from metafem.inversion import Design


@dataclass(frozen=True)
class Finding:
    """The result of one check."""

    what: str
    found: str
    well: bool


def examine() -> Iterator[Finding]:
    """Check the versions, the caches, the compiled kernels, a known contact, a part and a report."""
    yield Finding("python", platform.python_version(), True)
    yield _tried("metafem", _package)
    for name in needed():
        try:
            yield Finding(name, version(name), True)
        except PackageNotFoundError:
            yield Finding(name, "not installed; reinstall metafem", False)
    for what, trial in (
        ("cache", _cache),
        ("compiled kernels against Hertz's closed form", _contact),
        ("part of one asperity", _part),
        ("report", _page),
        ("result folder, written and read", _folder),
    ):
        yield _tried(what, trial)


def needed() -> list[str]:
    """Return the names of the packages that metafem requires."""
    try:
        stated = requires("metafem") or []
    except PackageNotFoundError:
        return []
    return [re.split(r"[^\w.-]", each, maxsplit=1)[0] for each in stated if "extra ==" not in each]


def megabytes(size: int) -> str:
    """Return a size in bytes as megabytes, with the unit."""
    return f"{size / 1e6:.1f} MB"


def _tried(what: str, trial: Callable[[], tuple[str, bool]]) -> Finding:
    try:
        found, well = trial()
    except Exception as error:  # every fault of the installation is reported
        return Finding(what, f"{type(error).__name__}: {error}", False)
    return Finding(what, found, well)


def _package() -> tuple[str, bool]:
    """Compare the folder of the imported metafem with the installed one."""
    imported = Path(metafem.__file__).parent
    try:
        installed = distribution("metafem")
    except PackageNotFoundError:
        return f"imported from {imported}, but not installed", False
    place = Path(str(installed.locate_file("metafem")))
    origin = json.loads(installed.read_text("direct_url.json") or "{}")
    if origin.get("dir_info", {}).get("editable"):
        place = Path(url2pathname(urlsplit(origin["url"]).path)) / "metafem"
    if place.resolve() != imported.resolve():
        found = f"imported from {imported}, but {place} is installed; reinstall metafem, or clear PYTHONPATH"
        return found, False
    return f"{installed.version}, imported from {imported}", True


def _cache() -> tuple[str, bool]:
    """Report the folder and the size of the caches, and try to write there."""
    folder = _caches.cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        return (
            f"{error}; each command compiles its kernels again; set {_caches.VARIABLE} to a writable folder"
        ), False
    kernels, blocks, studies = (
        megabytes(_caches.size(kept()))
        for kept in (_caches.kept_kernels, _caches.kept_blocks, _caches.kept_studies)
    )
    found = f"{folder}; compiled kernels {kernels}, influence of blocks {blocks}, stopped studies {studies}"
    return found, True


def _contact() -> tuple[str, bool]:

    surface = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material(1.0))
    area = float(mf.friction_law(surface, load=[0.01]).area[0])
    exact = math.pi * 0.5 * float(mf.Hertz().indentation_at_load(0.01, 0.5))
    error = abs(area / exact - 1.0)
    return f"relative error {error:.1e}", error < 1e-12


def _part() -> tuple[str, bool]:
    from metafem.files.part.block import block_mesh

    surface = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material(1.0))
    mesh = block_mesh(surface, mf.Block(2.0, 2.0, 1.0), 2e-4)
    return f"{len(mesh.faces)} triangles, {'closed' if mesh.closed else 'open'}", mesh.closed


def _page() -> tuple[str, bool]:

    length = len(mf.report.page(_design()))
    return f"{length} characters", length > 0


def _folder() -> tuple[str, bool]:

    design = _design()
    with tempfile.TemporaryDirectory() as parent:
        mf.save(design, f"{parent}/result")
        same = bool((mf.load(f"{parent}/result").surface.height == design.surface.height).all())
    return "equal to the bit" if same else "changed", same


def _design() -> Design:

    template = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.0))
    return mf.design(mf.LinearLaw(7.0), template)
