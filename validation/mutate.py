"""Mutants: constants, signs and terms of metafem are changed, which claims and default tests must notice."""

from __future__ import annotations

import multiprocessing
import os
import shutil
import sys
import tempfile
import tomllib
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path

import click

from metafem._caches import VARIABLE
from metafem._kernels.compiled import folder as kernels

ROOT = Path(__file__).parents[1]
LIST = Path(__file__).with_name("mutants.toml")

# Mutants at a time, and the time [s] after which a run that does not end counts as noticed.
PROCESSES, PATIENCE = 2, 900.0

# Packages that every run needs: loaded once in a process from which all others are forked.
LOADED = (
    *("numba", "xarray", "pandas", "pytest", "mpmath", "click", "rich", "joblib", "pydantic", "pint"),
    *("matplotlib.figure", "scipy.optimize", "scipy.special", "scipy.stats", "scipy.integrate", "scipy.fft"),
    *("scipy.sparse.linalg", "scipy.ndimage", "scipy.spatial", "scipy.interpolate", "skfem"),
)

# Packages of the copy, which must not be those of this folder.
OWN = ("metafem", "validation", "tests")

TESTS = ("-x", "-q", "-n", "0", "-m", "not slow", "-p", "no:cacheprovider")

# Row of the package without a change, which no claim and no test must notice.
UNCHANGED = "unchanged"


@dataclass(frozen=True)
class Mutant:
    """A change of one line of a file, and the claims and default tests that must notice it."""

    name: str
    file: str
    old: str
    new: str
    claims: Sequence[str]
    tests: Sequence[str]

    def applied(self, root: Path) -> None:
        """Change the file of a copy of the package."""
        path = root / self.file
        text = path.read_text("utf-8")
        if text.count(self.old) != 1:
            raise ValueError(
                f"{self.name}: {self.file} holds {self.old!r} {text.count(self.old)} times, not once"
            )
        path.write_text(text.replace(self.old, self.new), "utf-8")


@dataclass(frozen=True)
class Noticed:
    """The first check and the first default test that noticed a mutant; empty where none did."""

    name: str
    check: str
    test: str

    @property
    def passed(self) -> bool:
        """Whether both noticed the mutant, or neither the package without a change."""
        return not (self.check or self.test) if self.name == UNCHANGED else bool(self.check and self.test)

    def __str__(self) -> str:
        mark = "" if self.passed else "FAILED: "
        return f"{mark}{self.name}\n    claim  {self.check or 'none'}\n    test   {self.test or 'none'}"


def mutants() -> dict[str, Mutant]:
    """Return the listed mutants by name."""
    listed = tomllib.loads(LIST.read_text("utf-8"))
    return {name: Mutant(name, **row) for name, row in listed.items()}


def chosen(names: Sequence[str]) -> list[Mutant]:
    """Return the named mutants or all, after the package without a change."""
    known = mutants()
    if unknown := [name for name in names if name not in known]:
        raise click.BadParameter(f"{unknown[0]!r} is none of the mutants {', '.join(known)}")
    some = [known[name] for name in names or known]
    every = {
        kind: list(dict.fromkeys(x for each in some for x in getattr(each, kind)))
        for kind in ("claims", "tests")
    }
    return [Mutant(UNCHANGED, "README.md", "", "", **every), *some]


def noticed(mutant: Mutant) -> Noticed:
    """Run claims and default tests in a copy with the mutant, with caches of its own."""
    with tempfile.TemporaryDirectory(prefix="mutant-") as name:
        root, cache = Path(name, "copy"), Path(name, "cache")
        # with byte code; git's and other hidden folders are not needed
        shutil.copytree(ROOT, root, ignore=shutil.ignore_patterns(".*", "results"))
        if kernels().is_dir():
            shutil.copytree(kernels(), cache / "kernels" / kernels().name)
        if mutant.name != UNCHANGED:
            mutant.applied(root)
        return Noticed(mutant.name, *_in_process(mutant, root, cache))


def _in_process(mutant: Mutant, root: Path, cache: Path) -> tuple[str, str]:
    """Return the failed check and test that another process finds in a copy."""
    receiver, sender = FORKED.Pipe(duplex=False)
    process = FORKED.Process(target=_in_copy, args=(mutant.claims, mutant.tests, root, cache, sender))
    process.start()
    sender.close()
    late = f"no end within {PATIENCE:g} s"
    try:
        found = receiver.recv() if receiver.poll(PATIENCE) else (late, late)
    finally:
        process.kill()
        process.join()
    return found[0], found[1]


def _in_copy(
    claims: Sequence[str], tests: Sequence[str], root: Path, cache: Path, sender: Connection
) -> None:
    """Send what claims and tests of a copy notice."""
    for stream in (1, 2):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
    os.environ[VARIABLE] = str(cache)
    os.chdir(root)
    sys.path.insert(0, str(root))
    for name in [each for each in sys.modules if each.partition(".")[0] in OWN]:
        del sys.modules[name]
    sender.send((_check(claims), _test(tests)))


def _check(claims: Sequence[str]) -> str:
    """Return the first check of claims that fails, or nothing."""
    from validation.results import evaluate

    for name in claims:
        for check in evaluate(name).checks:
            if not check.passed:
                return f"{name}: {check.name}: {check.computed:.6g}, expected {check.expected}"
    return ""


def _test(paths: Sequence[str]) -> str:
    """Return the first default test that fails, or nothing."""
    import pytest

    failed: list[str] = []

    class Listener:
        def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
            failed.extend([report.nodeid] if report.failed else [])

        pytest_collectreport = pytest_runtest_logreport

    status = pytest.main([*TESTS, *paths], plugins=[Listener()])
    return failed[0] if failed else f"pytest: {status!r}" if status else ""


FORKED = multiprocessing.get_context("forkserver")
FORKED.set_forkserver_preload(list(LOADED))


def survivors(names: Sequence[str]) -> int:
    """Run the named mutants or all, print what noticed each, and return the number that were not noticed."""
    os.environ["OMP_NUM_THREADS"] = "1"
    count = 0
    with ThreadPoolExecutor(PROCESSES) as pool:
        for found in pool.map(noticed, chosen(names)):
            print(found, flush=True)
            count += not found.passed
    return count
