"""The benchmarks are listed, and no test needs one."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import metafem as mf
from validation.discovery import first_line, groups, module
from validation.scenes import stopped_runs
from validation.scenes.random_laws import LATTICE
from validation.timing import kernel_time

KINDS = ("rows", "long_rows")


@pytest.mark.slow
def test_every_benchmark_is_listed_with_one_line():
    done = subprocess.run(
        [sys.executable, "-m", "validation.benchmark", "--help"], capture_output=True, text=True, check=True
    )
    ((group, names),) = groups(*KINDS).items()
    assert group == "benchmark"
    assert {"designs", "interaction", "interruptions", "resolved", "studies"} <= set(names)
    assert "--long" in done.stdout
    for name in names:
        assert f"\n  {name} " in done.stdout
        assert first_line(module(name, *KINDS)).endswith(".")


def test_no_test_imports_a_benchmark():
    texts = {path: path.read_text("utf-8") for path in Path(__file__).parents[1].rglob("*.py")}
    for path in (path for path, text in texts.items() if "benchmark" in text):
        for node in ast.walk(ast.parse(texts[path])):
            names = [alias.name for alias in getattr(node, "names", []) if isinstance(alias, ast.alias)]
            source = getattr(node, "module", None) if isinstance(node, ast.ImportFrom) else None
            imported = [f"{source}.{name}" for name in names] if source else names
            assert not any(name.startswith("validation.benchmark") for name in imported), path


def test_the_kernel_is_timed_as_it_is_called():
    assert kernel_time(mf.Interacting(order=1), LATTICE, 3) > 0.0


@pytest.mark.slow
def test_no_file_is_lost_by_stopped_runs_or_by_two_at_once():
    # each signal, early and late, with and without a result to replace; `interruptions` stops 200 runs
    with stopped_runs.scene() as known:
        for tally in (stopped_runs.kills(known, 4), stopped_runs.pairs(known, 2)):
            assert tally.trials
            assert not tally.failures, tally.first
