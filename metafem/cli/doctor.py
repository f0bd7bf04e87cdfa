"""The command doctor: checks of the installation and of its caches."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from pathlib import Path

import click

import metafem as mf
from metafem import _caches
from metafem.cli.group import NOT_ACHIEVED
from metafem.cli.options import command, json_option
from metafem.cli.output import show

# A check: what it is, what it found, and whether this is well.
Finding = tuple[str, str, bool]


def _checked(what: str, check: Callable[[], tuple[str, bool]]) -> Finding:
    """Return the result of a check, which is a fault if the check raises an exception of any type."""
    try:
        return what, *check()
    except Exception as error:
        return what, f"{type(error).__name__}: {error}", False


def _kept() -> list[Path]:
    """Return the files and folders of the caches: compiled kernels, and the influence of blocks."""
    return [*_caches.kept_kernels(), *_caches.kept_blocks()]


def _cache() -> tuple[str, bool]:
    """Return the folder and size of the caches, or an error text, and whether the folder is writable."""
    folder = _caches.cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        return f"{error}; kernels are compiled again each time; set {_caches.VARIABLE} to a folder", False
    return f"{folder}; {_caches.size(_kept()) / 1e6:.1f} MB", True


def _contact() -> tuple[str, bool]:
    surface = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material(1.0))
    area = float(mf.friction_law(surface, load=[0.01]).area[0])
    error = abs(area / (math.pi * 0.5 * float(mf.Hertz().indentation_at_load(0.01, 0.5))) - 1.0)
    return f"relative error {error:.1e}", error < 1e-12


def _folder() -> tuple[str, bool]:
    block = mf.Block(8.0, 8.0, 2.0)
    template = mf.Surface.square_lattice(0.12, (4, 4), radius=0.5, material=mf.Material(1.0), block=block)
    design = mf.design(mf.LinearLaw(7.0), template)
    with tempfile.TemporaryDirectory() as parent:
        mf.save(design, f"{parent}/result", pages={"report.html": mf.report.page(design)})
        same = mf.load(f"{parent}/result") == design
    return "equal to the bit" if same else "changed", same


@command(
    click.option("--clear-cache", is_flag=True, help="Remove compiled kernels and influences of blocks."),
    json_option,
    short_help="Check the installation.",
)
def doctor(clear_cache: bool, as_json: bool) -> None:
    """Check the installation: versions, caches, compiled kernels, and a design with its files and report."""
    if clear_cache:
        folder, freed, left = _caches.cache_folder(), _caches.remove(_kept()), _caches.size(_kept())
        data = {"folder": str(folder), "freed_bytes": freed, "left_bytes": left}
        show(as_json, data, lines=[f"removed {freed / 1e6:.1f} MB from {folder}, left {left / 1e6:.1f} MB"])
        well = left == 0
    else:
        from metafem.files.result import versions

        findings: list[Finding] = [
            ("metafem", f"imported from {Path(mf.__file__).parent}", True),
            *((name, found, found != "not installed") for name, found in versions().items()),
            _checked("cache", _cache),
            _checked("compiled kernels against Hertz's closed form", _contact),
            _checked("design, part and report, written and read", _folder),
        ]
        well = all(good for *_, good in findings)
        lines = [f"{'ok  ' if good else 'FAIL'} {what}: {found}" for what, found, good in findings]
        show(as_json, [{"what": a, "found": b, "well": good} for a, b, good in findings], lines=lines)
    if not well:
        click.get_current_context().exit(NOT_ACHIEVED)
