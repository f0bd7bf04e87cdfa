"""Run tests and claims in a copy of the package with one change, and print which of them notice it."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import click

from metafem._caches import VARIABLE
from metafem._kernels.compiled import folder as kernels
from validation.mutants import Mutant, drawn, listed

ROOT = Path(__file__).parents[1]

# Mutants at a time, and the time [s] after which a run that does not end counts as noticed.
PROCESSES, PATIENCE = 2, 900.0

# The tests of the README's second command, and those that `.ci/run` runs beside them.
CORE = ("tests/core", "-m", "not slow")
SLOW = ("tests", "metafem", "-m", "slow and not nightly")


def tests_of(mutant: Mutant) -> list[Sequence[str]]:
    """Return the core tests of the changed folder and then all, or the browser tests for JavaScript."""
    if mutant.file.endswith(".js"):
        return [("tests/browser", "-m", "")]
    own = Path("tests/core", Path(mutant.file).parts[1])
    return [(str(own if (ROOT / own).is_dir() else "tests/core/package"), *CORE[1:]), CORE]


def noticed(mutant: Mutant | None, tests: Iterable[Sequence[str]], claims: Sequence[str]) -> tuple[str, str]:
    """Return the first test and the first check of claims that fail in a copy, or nothing for each."""
    with tempfile.TemporaryDirectory(prefix="mutant-") as name:
        copy, cache = Path(name, "copy"), Path(name, "cache")
        # with byte code; git's and other hidden folders are not needed
        shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".*", "results"))
        if kernels().is_dir():
            shutil.copytree(kernels(), cache / "kernels" / kernels().name)
        if mutant is not None:
            (copy / mutant.file).write_text(mutant.text, "utf-8")
        options = ("-x", "-q", "-n", "0", "-p", "no:cacheprovider")
        runs = (_failed(copy, cache, "pytest", *options, *some) for some in tests)
        test = next(filter(None, runs), "")
        return test, _failed(copy, cache, "validation", *claims, "-o", name) if claims else ""


def _failed(copy: Path, cache: Path, module: str, *arguments: str) -> str:
    """Run a module in a copy; return what it says has failed, or nothing."""
    own = {VARIABLE: str(cache), "PYTHONPATH": str(copy), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, "-m", module, *arguments]
    try:
        done = subprocess.run(
            command, cwd=copy, env=os.environ | own, capture_output=True, text=True, timeout=PATIENCE
        )
    except subprocess.TimeoutExpired:
        return f"no end within {PATIENCE:g} s"
    if done.returncode == 0:
        return ""
    found = re.search(r"^(?:FAILED|ERROR|failed:) (.*?)(?: - .*)?$", done.stdout, re.MULTILINE)
    return found[1] if found else f"{module} ends with {done.returncode}"


def _all(some: Sequence[Mutant], tests: Sequence[str] | None = None) -> Iterable[tuple[str, str]]:
    """Yield what notices each mutant; refuse a copy that fails without a change: all would seem noticed."""
    claims = sorted({claim for mutant in some for claim in mutant.claims})
    if any(found := noticed(None, [tests or CORE], claims)):
        raise click.ClickException(f"without a change {' and '.join(filter(None, found))} fail in a copy")
    with ThreadPoolExecutor(PROCESSES) as pool:
        yield from pool.map(
            lambda mutant: noticed(mutant, [tests] if tests else tests_of(mutant), mutant.claims), some
        )


def survivors(names: Sequence[str]) -> int:
    """Run the named mutants or all of the list, print what notices each, and return how many pass unnoticed.

    A core test must notice each, and one of its claims where it names any.
    """
    known = listed(ROOT)
    if unknown := [name for name in names if name not in known]:
        raise click.BadParameter(f"{unknown[0]!r} is none of the mutants {', '.join(known)}")
    some = [known[name] for name in names or known]
    count = 0
    for mutant, (test, check) in zip(some, _all(some), strict=True):
        passed = bool(test) and (bool(check) or not mutant.claims)
        count += not passed
        print(f"{'' if passed else 'FAILED: '}{mutant.name}\n    test   {test or 'none'}", flush=True)
        if mutant.claims:
            print(f"    claim  {check or 'none'}", flush=True)
    print(f"{len(some) - count} of {len(some)} mutants are noticed")
    return count


def survey(count: int, seed: int = 0) -> None:
    """Print which of so many random mutants core tests notice, and which of the others slow tests do."""
    some = drawn(ROOT, count, seed)
    for kind, tests in (("core", None), ("slow", SLOW)):
        left = []
        for mutant, (test, _) in zip(some, _all(some, tests), strict=True):
            print(f"{kind}: {test or 'none'}\n    {mutant.name}", flush=True)
            left += [] if test else [mutant]
        print(f"{kind} tests notice {len(some) - len(left)} of {len(some)} mutants")
        some = left
