"""`metafem doctor`: checks of the installation and of its caches."""

from __future__ import annotations

import json
import math
import platform
import re
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, distribution, requires, version
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import urlsplit
from urllib.request import url2pathname

import click

import metafem as mf
from metafem import _caches
from metafem.cli.group import NOT_ACHIEVED
from metafem.cli.options import command, json_option

if TYPE_CHECKING:
    from metafem.inversion import Design


# Content of each cache.
CACHES = {"kernels": "compiled kernels", "blocks": "influence of blocks"}


@dataclass(frozen=True)
class Finding:
    """The result of one check."""

    what: str
    found: str
    well: bool


def examine() -> Iterator[Finding]:
    """Yield the results of the checks: versions, cache, kernels, a part, a report and a result folder."""
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
    """Return the names of the packages that metafem requires, without those of its extras."""
    try:
        stated = requires("metafem") or []
    except PackageNotFoundError:
        return []
    return [re.split(r"[^\w.-]", each, maxsplit=1)[0] for each in stated if "extra ==" not in each]


def megabytes(size: int) -> str:
    """Return the text of a size in megabytes; `size` is in bytes."""
    return f"{size / 1e6:.1f} MB"


def _sizes(caches: Mapping[str, int]) -> str:
    """Return a text with the size of each cache; `caches` holds the sizes in bytes."""
    return ", ".join(f"{CACHES[name]} {megabytes(size)}" for name, size in caches.items())


def _kept() -> dict[str, list[Path]]:
    """Return the files and folders of each cache."""
    paths = (_caches.kept_kernels(), _caches.kept_blocks())
    return dict(zip(CACHES, paths, strict=True))


def _tried(what: str, trial: Callable[[], tuple[str, bool]]) -> Finding:
    try:
        found, well = trial()
    except Exception as error:  # an exception of any type is a fault of the installation
        return Finding(what, f"{type(error).__name__}: {error}", False)
    return Finding(what, found, well)


def _package() -> tuple[str, bool]:
    """Return whether the imported metafem is the installed one, with a description."""
    imported = Path(mf.__file__).parent
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
    """Return the folder and size of the caches, or an error text, and whether the folder is writable."""
    folder = _caches.cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        return (
            f"{error}; each command compiles its kernels again; set {_caches.VARIABLE} to a writable folder"
        ), False
    return f"{folder}; {_sizes({name: _caches.size(paths) for name, paths in _kept().items()})}", True


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


@command(
    click.option(
        "--clear-cache", is_flag=True, help="Remove compiled kernels and the stored influence of blocks."
    ),
    json_option,
    short_help="Check the installation.",
)
def doctor(clear_cache: bool, as_json: bool) -> None:
    """Check the installation: versions, caches, compiled kernels, a test contact, part and report."""
    if clear_cache:
        _clear_cache(as_json)
        return

    findings = list(examine())
    if as_json:
        click.echo(json.dumps([asdict(finding) for finding in findings]))
    else:
        for finding in findings:
            mark = click.style("ok  ", fg="green") if finding.well else click.style("FAIL", fg="red")
            click.echo(f"{mark} {finding.what}: {finding.found}")
    sys.exit(0 if all(finding.well for finding in findings) else NOT_ACHIEVED)


def _clear_cache(as_json: bool) -> None:

    try:
        folder = _caches.cache_folder()
        freed = {name: _caches.remove(paths) for name, paths in _kept().items()}
        left = _caches.size([path for paths in _kept().values() for path in paths])
    except OSError as error:
        raise click.ClickException(f"the cache cannot be cleared: {error}") from None
    if as_json:
        data = {f"{name}_bytes": number for name, number in {**freed, "left": left}.items()}
        click.echo(json.dumps({"folder": str(folder), **data}))
    else:
        click.echo(f"removed from {folder}: {_sizes(freed)}")
    if left:
        raise click.ClickException(f"{megabytes(left)} in {folder} could not be removed")
