"""The command doctor: checks of the installation."""

from __future__ import annotations

import math
import sys
import tempfile
from pathlib import Path

import metafem as mf
from metafem import _caches
from metafem.cli import NOT_ACHIEVED
from metafem.cli.options import command, json_option
from metafem.cli.output import show
from metafem.errors import refuse_if


def _installed() -> str:
    from metafem.files.result import versions

    found = ", ".join(f"{name} {version}" for name, version in versions().items())
    return f"{found}, imported from {Path(mf.__file__).parent}"


def _cache() -> str:
    folder = _caches.cache_folder()
    folder.mkdir(parents=True, exist_ok=True)
    tempfile.TemporaryFile(dir=folder).close()
    return str(folder)


def _contact() -> str:
    surface = mf.Surface([[0.0, 0.0]], [0.1], 0.5, mf.Material(1.0))
    area = float(mf.friction_law(surface, load=[0.01]).area[0])
    error = abs(area / (math.pi * 0.5 * float(mf.Hertz().indentation_at_load(0.01, 0.5))) - 1.0)
    refuse_if(error > 1e-12, f"relative error {error:.1e}")
    return f"relative error {error:.1e}"


def _folder() -> str:
    block = mf.Block(8.0, 8.0, 2.0)
    template = mf.Surface.square_lattice(0.12, (4, 4), radius=0.5, material=mf.Material(1.0), block=block)
    design = mf.design(mf.LinearLaw(7.0), template)
    with tempfile.TemporaryDirectory() as parent:
        mf.save(design, f"{parent}/result", pages={"report.html": mf.report.page(design)})
        refuse_if(mf.load(f"{parent}/result") != design, "changed")
    return "equal to the bit"


# The checks: each returns what it found, or raises an exception of any type.
CHECKS = {
    "versions": _installed,
    f"cache ({_caches.VARIABLE} names another folder)": _cache,
    "compiled kernels against Hertz's closed form": _contact,
    "design, part and report, written and read": _folder,
}


@command(json_option, short_help="Check the installation.")
def doctor(as_json: bool) -> None:
    """Check the installation: versions, caches, compiled kernels, and a design with its files and report."""
    findings = []
    for what, check in CHECKS.items():
        try:
            findings.append({"what": what, "found": check(), "well": True})
        except Exception as error:
            findings.append({"what": what, "found": f"{type(error).__name__}: {error}", "well": False})
    show(
        as_json,
        findings,
        lines=[f"{'ok  ' if each['well'] else 'FAIL'} {each['what']}: {each['found']}" for each in findings],
    )
    if not all(each["well"] for each in findings):
        sys.exit(NOT_ACHIEVED)
