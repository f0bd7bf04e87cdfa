"""The command in an empty folder."""

import shutil
from importlib import import_module

import pytest
from click.testing import CliRunner

from metafem import cli
from metafem.drawing.inline import Drawn


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Run a command in an empty folder and return its result."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        result = CliRunner().invoke(cli.main, [str(argument) for argument in arguments])
        assert result.exception is None or isinstance(result.exception, SystemExit)
        return result

    return call


@pytest.fixture
def plain_reports(monkeypatch):
    """Leave the pictures, which take most of the time of a design, out of reports other than the demos'."""
    monkeypatch.setattr(
        import_module("metafem.report.page"), "drawn", lambda figure, title: Drawn(title, "", "", "")
    )


@pytest.fixture
def demo(demo_results, run, tmp_path):
    """Copy what a demo wrote into the folder of a test, and return the data that it printed."""

    def call(name):
        folder, data = demo_results(name)
        shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
        return data

    return call
