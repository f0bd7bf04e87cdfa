"""The command doctor: checks of the installation and of its caches."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import click

import metafem as mf
from metafem import _caches
from metafem.cli.group import NOT_ACHIEVED
from metafem.cli.options import command, json_option
from metafem.cli.output import show

# A check: what it is, what it found, and whether this is well.
Finding = tuple[str, str, bool]


def examine() -> Iterator[Finding]:
    """Yield the results of the checks: versions, cache, kernels, a part, a report and a result folder."""
    from metafem.files.result import versions

    yield "metafem", f"imported from {Path(mf.__file__).parent}", True
    for name, found in versions().items():
        yield name, found, found != "not installed"
    checks: dict[str, Callable[[], tuple[str, bool]]] = {
        "cache": _cache,
        "compiled kernels against Hertz's closed form": _contact,
        "part of one asperity": _part,
        "result folder and report, written and read": _folder,
    }
    for what, trial in checks.items():
        try:
            yield what, *trial()
        except Exception as error:  # an exception of any type is a fault of the installation
            yield what, f"{type(error).__name__}: {error}", False


def _kept() -> dict[str, list[Path]]:
    """Return the files and folders of each cache."""
    return {"kernels": _caches.kept_kernels(), "blocks": _caches.kept_blocks()}


def _cache() -> tuple[str, bool]:
    """Return the folder and size of the caches, or an error text, and whether the folder is writable."""
    folder = _caches.cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        remedy = f"set {_caches.VARIABLE} to a writable folder"
        return f"{error}; each command compiles its kernels again; {remedy}", False
    return f"{folder}; {_sizes({name: _caches.size(paths) for name, paths in _kept().items()})}", True


def _contact() -> tuple[str, bool]:
    surface = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material(1.0))
    area = float(mf.friction_law(surface, load=[0.01]).area[0])
    error = abs(area / (math.pi * 0.5 * float(mf.Hertz().indentation_at_load(0.01, 0.5))) - 1.0)
    return f"relative error {error:.1e}", error < 1e-12


def _part() -> tuple[str, bool]:
    from metafem.files.mesh import block_mesh

    surface = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material(1.0))
    mesh = block_mesh(surface, mf.Block(2.0, 2.0, 1.0), 2e-4)
    return f"{len(mesh.faces)} triangles, {'closed' if mesh.closed else 'open'}", mesh.closed


def _folder() -> tuple[str, bool]:
    template = mf.Surface.square_lattice(0.12, (4, 4), radius=0.526, material=mf.Material(1.0))
    design = mf.design(mf.LinearLaw(7.0), template)
    with tempfile.TemporaryDirectory() as parent:
        mf.save(design, f"{parent}/result", pages={"report.html": mf.report.page(design)})
        same = mf.load(f"{parent}/result") == design
    return "equal to the bit" if same else "changed", same


def _sizes(caches: dict[str, int]) -> str:
    """Return a text with the size of each cache; `caches` holds the sizes in bytes."""
    return ", ".join(f"{name} {size / 1e6:.1f} MB" for name, size in caches.items())


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
        folder = _caches.cache_folder()
        sizes = {name: _caches.remove(paths) for name, paths in _kept().items()}
        sizes["left"] = _caches.size([path for paths in _kept().values() for path in paths])
        data = {f"{name}_bytes": number for name, number in sizes.items()}
        show(as_json, {"folder": str(folder), **data}, lines=[f"removed from {folder}: {_sizes(sizes)}"])
        well = sizes["left"] == 0
    else:
        findings = list(examine())
        well = all(good for *_, good in findings)
        lines = [f"{'ok  ' if good else 'FAIL'} {what}: {found}" for what, found, good in findings]
        show(as_json, [{"what": a, "found": b, "well": good} for a, b, good in findings], lines=lines)
    if not well:
        click.get_current_context().exit(NOT_ACHIEVED)
