"""The entry point: signals, files of the user, and completion in a shell."""

import signal
import sys
from pathlib import Path

import pytest

from metafem import cli
from metafem.files import Specification, demo_text


@pytest.fixture(autouse=True)
def kept_handlers():
    """Let Ctrl-C raise, as in a terminal, also in the background; the entry point sets handlers for good."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler), signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGINT, before[0])
    signal.signal(signal.SIGTERM, before[1])


def test_a_shell_offers_the_models_that_begin_so(monkeypatch, capsys):
    monkeypatch.setenv("_METAFEM_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", "metafem design --model l")
    monkeypatch.setenv("COMP_CWORD", "3")
    with pytest.raises(SystemExit) as end:
        cli.run()
    assert end.value.code == 0
    offered = [entry.partition(",")[2] for entry in capsys.readouterr().out.splitlines()]
    assert offered == ["layer"]


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_stopped_design_leaves_nothing(tmp_path, monkeypatch, number, code):
    monkeypatch.chdir(tmp_path)
    Path("small.toml").write_text(demo_text("linear"), "utf-8")
    monkeypatch.setattr(Specification, "design", lambda *_: signal.raise_signal(number))
    monkeypatch.setattr(sys, "argv", ["metafem", "design", "small.toml", "-o", "out"])
    with pytest.raises(SystemExit) as end:
        cli.run()
    assert end.value.code == code
    assert [path.name for path in Path().iterdir()] == ["small.toml"]


@pytest.mark.usefixtures("plain_reports")
def test_files_of_the_user_are_not_replaced_without_force(run):
    Path("small.toml").write_text(demo_text("linear"), "utf-8")
    assert run("design", "small.toml", "-o", "out").exit_code == 0
    for name, command in (
        ("law.csv", ("predict", "out", "-o", "law.csv")),
        ("out/interaction.nc", ("study", "interaction", "out")),
        ("out/mould.csv", ("design", "small.toml", "-o", "out")),
    ):
        Path(name).write_text("mine")
        assert "--force" in run(*command).refusal
        assert Path(name).read_text() == "mine"
    assert run("predict", "out", "-o", "law.csv", "--force").exit_code == 0
    assert Path("law.csv").read_text() != "mine"
    Path("other").mkdir()
    Path("other/mine.txt").write_text("mine")
    assert "no result folder" in run("design", "small.toml", "-o", "other", "--force").refusal
