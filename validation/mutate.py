"""Run the tests that enter a changed function in a copy of the package, and print which of them notice it."""

from __future__ import annotations

import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path

import click

from metafem._caches import VARIABLE
from metafem._kernels.compiled import folder as kernels
from validation import entered
from validation.mutants import Mutant, drawn, listed, module_of

ROOT = Path(__file__).parents[1]

# Mutants at a time; the time [s] after which a run that does not end counts as noticed; and the processor
# time [s] of all tests that are run for a mutant, those that take least first.
PROCESSES, PATIENCE, MOST = 2, 900.0, 120.0

# Packages that every run needs: loaded once in a process from which all others are forked.
LOADED = (
    *("numba", "xarray", "pandas", "pytest", "mpmath", "click", "rich", "joblib", "pydantic"),
    *("matplotlib.figure", "scipy.optimize", "scipy.special", "scipy.stats", "scipy.integrate", "scipy.fft"),
    *("scipy.sparse.linalg", "scipy.ndimage", "scipy.spatial", "scipy.interpolate", "skfem"),
)

# Packages of the copy, which must not be those of this folder.
OWN = ("metafem", "validation", "tests")

# The tests of the README's second command, and those that `.ci/run` runs beside them.
CORE = ("tests/core", "-m", "not slow")
SLOW = ("tests", "metafem", "-m", "slow and not nightly", "--dist", "loadfile")


def recorded(root: Path, arguments: Sequence[str]) -> entered.Entered:
    """Run tests, which must pass, and return which of them enter each function."""
    with tempfile.TemporaryDirectory(prefix="entered-") as folder:
        command = [sys.executable, "-m", "pytest", "-q", "-p", "validation.entered", *arguments]
        subprocess.run(command, cwd=root, check=True, env=os.environ | {entered.FOLDER: folder})
        return entered.read(Path(folder))


def tests_of(mutant: Mutant, record: entered.Entered, root: Path) -> list[str]:
    """Return the tests that enter a changed function, or what calls a compiled one, quickest first."""
    if mutant.file.endswith(".js"):
        return sorted(str(path.relative_to(root)) for path in (root / "tests/browser").glob("test_*.py"))
    if mutant.function.startswith("metafem._kernels"):
        callers = tuple(_callers_of_kernels(root))
        names = [name for name in record if name.startswith(callers)]
    else:  # what stands outside functions may concern all functions of its module
        names = [name for name in record if name == mutant.function]
        names = names or [name for name in record if name.startswith(module_of(mutant.file) + ".")]
    tests = sorted({test for name in names for test in record[name]})
    total, chosen = 0.0, []
    for seconds, test in tests:
        total += seconds
        if total <= MOST:
            chosen.append(test)
    return chosen


def _callers_of_kernels(root: Path) -> Iterable[str]:
    """Yield the modules that import compiled functions."""
    for path in (root / "metafem").rglob("*.py"):
        if "_kernels" not in path.parts and re.search(
            r"^from metafem\._kernels", path.read_text("utf-8"), re.M
        ):
            yield ".".join(path.relative_to(root).with_suffix("").parts) + "."


def noticed(mutant: Mutant, tests: Sequence[str], root: Path = ROOT) -> tuple[str, str]:
    """Return the first test and the first check of claims that fail in a copy, or nothing for each."""
    with tempfile.TemporaryDirectory(prefix="mutant-") as name:
        copy, cache = Path(name, "copy"), Path(name, "cache")
        # with byte code; git's and other hidden folders are not needed
        shutil.copytree(root, copy, ignore=shutil.ignore_patterns(".*", "results"))
        if kernels().is_dir():
            shutil.copytree(kernels(), cache / "kernels" / kernels().name)
        mutant.applied(copy)
        receiver, sender = FORKED.Pipe(duplex=False)
        process = FORKED.Process(target=_in_copy, args=(mutant.claims, tests, copy, cache, sender))
        process.start()
        sender.close()
        late = f"no end within {PATIENCE:g} s"
        try:
            found = receiver.recv() if receiver.poll(PATIENCE) else (late, late)
        except EOFError:
            found = ("the process ended", "the process ended")
        finally:
            process.kill()
            process.join()
        return found[0], found[1]


def _in_copy(
    claims: Sequence[str], tests: Sequence[str], root: Path, cache: Path, sender: Connection
) -> None:
    """Send what tests and claims of a copy notice."""
    for stream in (1, 2):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream)
    os.environ[VARIABLE] = str(cache)
    os.chdir(root)
    sys.path.insert(0, str(root))
    for name in [each for each in sys.modules if each.partition(".")[0] in OWN]:
        del sys.modules[name]
    sender.send((_test(tests), _check(claims)))


def _check(claims: Sequence[str]) -> str:
    """Return the first check of claims that fails, or nothing."""
    if claims:
        from validation.results import evaluate

        for name in claims:
            for check in evaluate(name).checks:
                if not check.passed:
                    return f"{name}: {check.name}: {check.computed:.6g}, expected {check.expected}"
    return ""


def _test(tests: Sequence[str]) -> str:
    """Return the first test that fails, or nothing."""
    if not tests:
        return ""
    import pytest

    failed: list[str] = []

    class Chosen:
        def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
            place = {test: k for k, test in enumerate(tests)}
            some = [item for item in items if item.nodeid in place or item.nodeid.partition("::")[0] in place]
            items[:] = sorted(some, key=lambda item: place.get(item.nodeid, 0))

        def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
            failed.extend([report.nodeid] if report.failed else [])

        pytest_collectreport = pytest_runtest_logreport

    files = dict.fromkeys(test.partition("::")[0] for test in tests)
    options = ("-x", "-q", "-n", "0", "-m", "", "-p", "no:cacheprovider")
    status = pytest.main([*options, *files], plugins=[Chosen()])
    return failed[0] if failed else f"pytest: {status!r}" if status else ""


FORKED = multiprocessing.get_context("forkserver")
FORKED.set_forkserver_preload(list(LOADED))


def _refuse_a_broken_copy(record: entered.Entered, claims: Iterable[str] = ()) -> None:
    """Raise an error if tests or claims fail in a copy without a change: all mutants would seem noticed."""
    readme = "README.md"
    unchanged = Mutant("unchanged", "", readme, (ROOT / readme).read_text("utf-8"), [*dict.fromkeys(claims)])
    tests = sorted({test for some in record.values() for _, test in some})
    if any(found := noticed(unchanged, tests)):
        raise click.ClickException(f"without a change {' and '.join(filter(None, found))} fail in a copy")


def survivors(names: Sequence[str]) -> int:
    """Run the named mutants or all of the list, print what notices each, and return how many pass unnoticed.

    A core test must notice each, and one of its claims where it names any.
    """
    known = listed(ROOT)
    if unknown := [name for name in names if name not in known]:
        raise click.BadParameter(f"{unknown[0]!r} is none of the mutants {', '.join(known)}")
    some = [known[name] for name in names or known]
    os.environ["OMP_NUM_THREADS"] = "1"
    record = recorded(ROOT, CORE)
    _refuse_a_broken_copy(record, (claim for mutant in some for claim in mutant.claims))
    with ThreadPoolExecutor(PROCESSES) as pool:
        run = partial(_with_tests, record=record)
        count = 0
        for mutant, (test, check) in zip(some, pool.map(run, some), strict=True):
            passed = bool(test) and (bool(check) or not mutant.claims)
            count += not passed
            print(f"{'' if passed else 'FAILED: '}{mutant.name}\n    test   {test or 'none'}", flush=True)
            if mutant.claims:
                print(f"    claim  {check or 'none'}", flush=True)
    print(f"{len(some) - count} of {len(some)} mutants are noticed")
    return count


def _with_tests(mutant: Mutant, record: entered.Entered, root: Path = ROOT) -> tuple[str, str]:
    return noticed(mutant, tests_of(mutant, record, root), root)


def survey(count: int, seed: int = 0) -> None:
    """Print which of so many random mutants core tests notice, and which of the others slow tests do."""
    os.environ["OMP_NUM_THREADS"] = "1"
    some = drawn(ROOT, count, seed)
    for kind, arguments in (("core", CORE), ("slow", SLOW)):
        record = recorded(ROOT, arguments)
        _refuse_a_broken_copy(record)
        left = []
        with ThreadPoolExecutor(PROCESSES) as pool:
            run = partial(_with_tests, record=record)
            for mutant, (test, _) in zip(some, pool.map(run, some), strict=True):
                print(f"{kind}: {test or 'none'}\n    {mutant.name}", flush=True)
                left += [] if test else [mutant]
        print(f"{kind} tests notice {len(some) - len(left)} of {len(some)} mutants")
        some = left
