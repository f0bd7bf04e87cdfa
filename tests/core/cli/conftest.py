"""The command in an empty folder."""

import json
import shutil
from importlib import import_module

import pytest
from click.testing import CliRunner

from metafem import cli
from metafem.drawing.inline import Drawn


class Ran:
    """A command that ran: its exit code and what it printed."""

    def __init__(self, result):
        self.result = result

    def __getattr__(self, name):
        return getattr(self.result, name)

    @property
    def words(self):
        """The output with single blanks."""
        return " ".join(self.output.split())

    def ended(self, code):
        assert self.exit_code == code, self.output
        return self

    told = property(lambda self: self.ended(0).words)
    data = property(lambda self: json.loads(self.ended(0).stdout))
    missed = property(lambda self: json.loads(self.ended(1).stdout))
    refusal = property(lambda self: self.ended(2).words)


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Run a command in an empty folder and return its result."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        result = CliRunner().invoke(cli.main, [str(argument) for argument in arguments])
        assert result.exception is None or isinstance(result.exception, SystemExit)
        return Ran(result)

    return call


@pytest.fixture
def plain_reports(monkeypatch):
    """Leave the pictures, which take most of the time of a design, out of reports other than the demos'."""
    monkeypatch.setattr(
        import_module("metafem.report.page"), "drawn", lambda figure, title: Drawn(title, "", "")
    )


@pytest.fixture
def demo(demo_results, run, tmp_path):
    """Copy what a demo wrote into the folder of a test, and return the data that it printed."""

    def call(name):
        folder, data = demo_results(name)
        shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
        return data

    return call
