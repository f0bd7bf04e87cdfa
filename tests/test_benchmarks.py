"""The benchmarks are found, and the README shows the table of their models."""

import re
from xml.dom import minidom

import pytest
from click.testing import CliRunner

import metafem as mf
from validation.benchmark import interaction, interruptions, work_precision
from validation.benchmark.__main__ import MARKS, benchmarks, main
from validation.readme import README


def shown():
    """Rows of the README's table of models, as lists of cells."""
    part = README.read_text("utf-8").split(MARKS[0])[1].split(MARKS[1])[0]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in part.strip().splitlines()[2:]]


def test_what_takes_long_is_apart():
    assert {"designs", "interaction", "resolved", "work_precision"} <= set(benchmarks())
    assert {"interaction", "resolved"} <= set(benchmarks("long_rows"))
    help_text = CliRunner().invoke(main, ["--help"]).output
    assert "--long" in help_text


def test_the_kernel_is_timed_as_it_is_called():
    assert interaction.kernel_time(mf.Interacting(order=1), interaction.small(), 3) > 0.0


def test_readme_shows_every_model_with_its_assumption_and_range():
    wanted = [[f"`{name}`", assumes, span] for name, _, _, assumes, span in work_precision.TABLE]
    assert [[row[0], row[1], row[-1]] for row in shown()] == wanted
    for name, line, setting, *_ in work_precision.TABLE:
        assert eval(f"mf.{name}", {"mf": mf}) == work_precision.LINES[line][setting]


@pytest.mark.slow
def test_errors_in_the_readme_are_those_of_the_models():
    reference = {load: work_precision.reference(load) for load in work_precision.LOADS}
    doubt = max(uncertain for _, uncertain in reference.values())
    for (_, line, setting, *_), row in zip(work_precision.TABLE, shown(), strict=True):
        model = work_precision.LINES[line][setting]
        errors = [
            abs(work_precision.state(model, load).area / area - 1) for load, (area, _) in reference.items()
        ]
        assert row[4] == work_precision.shown_error(max(errors), doubt)


@pytest.mark.slow
def test_no_file_is_lost_by_stopped_runs_or_by_two_at_once():
    for row in interruptions.long_rows(10, 5):
        assert row.measured == row.wanted, row


def test_picture_is_drawn():
    document = minidom.parse(str(work_precision.PICTURE))
    labels = re.findall(r"(Interacting|BoundaryElements|Independent)\(", document.toxml())
    assert len(set(labels)) == 3


def test_times_are_rounded_to_one_two_and_five():
    assert [work_precision.rounded(t) for t in (1.4e-6, 3.9e-5, 0.4, 2.4)] == [
        "1 µs",
        "50 µs",
        "500 ms",
        "2 s",
    ]
