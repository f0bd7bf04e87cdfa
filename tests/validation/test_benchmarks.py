"""The benchmarks are listed, no test needs one, and the README shows the table of the models."""

import ast
import re
import subprocess
import sys
from pathlib import Path
from xml.dom import minidom

import pytest

import metafem as mf
from validation.discovery import first_line, groups, module
from validation.readme import README
from validation.scenes import model_table, stopped_runs
from validation.scenes.random_laws import LATTICE
from validation.timing import kernel_time

KINDS = ("rows", "long_rows")


def shown():
    """Rows of the README's table of models, as lists of cells."""
    part = README.read_text("utf-8").split(model_table.MARKS[0])[1].split(model_table.MARKS[1])[0]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in part.strip().splitlines()[2:]]


def test_every_benchmark_is_listed_with_one_line():
    done = subprocess.run(
        [sys.executable, "-m", "validation.benchmark", "--help"], capture_output=True, text=True, check=True
    )
    ((group, names),) = groups(*KINDS).items()
    assert group == "benchmark"
    assert {"designs", "interaction", "interruptions", "resolved", "work_precision"} <= set(names)
    assert "--long" in done.stdout
    for name in names:
        assert f"\n  {name} " in done.stdout
        assert first_line(module(name, *KINDS)).endswith(".")


def test_no_test_imports_a_benchmark():
    for path in Path(__file__).parents[1].rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            names = [alias.name for alias in getattr(node, "names", []) if isinstance(alias, ast.alias)]
            source = getattr(node, "module", None) if isinstance(node, ast.ImportFrom) else None
            imported = [f"{source}.{name}" for name in names] if source else names
            assert not any(name.startswith("validation.benchmark") for name in imported), path


def test_the_kernel_is_timed_as_it_is_called():
    assert kernel_time(mf.Interacting(order=1), LATTICE, 3) > 0.0


def test_readme_shows_every_model_with_its_assumption_and_range():
    expected = [[f"`{name}`", assumes, span] for name, _, _, assumes, span in model_table.TABLE]
    assert [[row[0], row[1], row[-1]] for row in shown()] == expected
    for name, line, setting, *_ in model_table.TABLE:
        assert eval(f"mf.{name}", {"mf": mf}) == model_table.LINES[line][setting]


@pytest.mark.slow
def test_errors_in_the_readme_are_those_of_the_models():
    reference = {load: model_table.reference(load) for load in model_table.LOADS}
    uncertainty = max(change for _, change in reference.values())
    for (_, line, setting, *_), row in zip(model_table.TABLE, shown(), strict=True):
        model = model_table.LINES[line][setting]
        errors = [
            abs(model_table.state(model, load).area / area - 1) for load, (area, _) in reference.items()
        ]
        assert row[4] == model_table.shown_error(max(errors), uncertainty)


@pytest.mark.slow
def test_no_file_is_lost_by_stopped_runs_or_by_two_at_once():
    with stopped_runs.scene() as known:
        for tally in (stopped_runs.kills(known, 10), stopped_runs.pairs(known, 5)):
            assert tally.trials
            assert not tally.failures, tally.first


def test_picture_is_drawn():
    document = minidom.parse(str(model_table.PICTURE))
    labels = re.findall(r"(Interacting|BoundaryElements|Independent)\(", document.toxml())
    assert len(set(labels)) == 3


def test_times_are_rounded_to_one_two_and_five():
    assert [model_table.rounded(t) for t in (1.4e-6, 3.9e-5, 0.4, 2.4)] == [
        "1 µs",
        "50 µs",
        "500 ms",
        "2 s",
    ]
