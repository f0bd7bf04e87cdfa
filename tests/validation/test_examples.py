"""The examples run, print, assert a number and draw."""

import re
import runpy
from pathlib import Path

import pytest
from matplotlib.figure import Figure

import validation

SCRIPTS = sorted((Path(validation.__file__).parent / "examples").glob("e*.py"))


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.stem)
def test_examples_run_print_assert_a_number_and_draw(path, capsys):
    figure = runpy.run_path(str(path))["figure"]
    assert re.search(r"^ *assert ", path.read_text("utf-8"), re.MULTILINE)
    assert capsys.readouterr().out.count("\n") >= 2
    assert isinstance(figure, Figure)
    assert figure.axes[0].get_xlabel()
