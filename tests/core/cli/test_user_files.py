"""Commands that are stopped, and files of the user."""

import signal
from pathlib import Path

import pytest
from click.testing import CliRunner

from metafem import cli
from metafem.files import Specification, demo_text


@pytest.fixture(autouse=True)
def listening():
    """Shells start jobs in the background with Ctrl-C ignored; the entry point sets handlers for good."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler), signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGINT, before[0])
    signal.signal(signal.SIGTERM, before[1])


@pytest.fixture
def run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("small.toml").write_text(demo_text("linear"), "utf-8")
    return lambda *arguments: CliRunner().invoke(cli.main, arguments)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_stopped_design_leaves_nothing(run, monkeypatch, number, code):
    monkeypatch.setattr(Specification, "design", lambda *_: signal.raise_signal(number))
    before = [signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)]
    assert run("design", "small.toml", "-o", "out").exit_code == code
    assert [path.name for path in Path().iterdir()] == ["small.toml"]
    assert [signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)] == before


@pytest.mark.usefixtures("plain_reports")
def test_files_of_the_user_are_never_replaced(run):
    assert run("design", "small.toml", "-o", "out").exit_code == 0
    assert run("predict", "out", "-o", "law.csv").exit_code == 0
    assert run("predict", "out", "-o", "law.csv", "--force").exit_code == 0
    for name, command in (
        ("law.csv", ("predict", "out", "-o", "law.csv", "--force")),
        ("out/report.html", ("report", "out")),
        ("out/interaction.nc", ("study", "interaction", "out", "--force")),
        ("out/mould.csv", ("design", "small.toml", "-o", "out", "--force")),
    ):
        Path(name).write_text("mine")
        result = run(*command)
        assert (result.exit_code, "so it is not replaced" in result.output) == (2, True), result.output
        assert Path(name).read_text() == "mine"
