"""The entry point: signals before, in and after a command, files of the user, and completion in a shell."""

import signal
import subprocess
import sys
import threading
import weakref
from pathlib import Path

import pytest

from metafem import cli
from metafem.cli.signals import stopped_by_signals
from metafem.files import Specification, demo_text


@pytest.fixture(autouse=True)
def kept_handlers():
    """Let Ctrl-C raise, as in a terminal, also in the background; the entry point sets handlers for good."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler), signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGINT, before[0])
    signal.signal(signal.SIGTERM, before[1])


def test_an_ignored_signal_stays_ignored():
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    with stopped_by_signals():
        signal.raise_signal(signal.SIGINT)
    assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN


def test_a_signal_in_the_callback_of_a_weak_reference_is_not_lost():
    class Thing:
        pass

    things = [Thing()]
    watched = weakref.ref(things[0], lambda _: signal.raise_signal(signal.SIGTERM))

    def work():
        things.clear()
        threading.Event().wait(5.0)
        pytest.fail("the signal did not end what the command waited for")

    with pytest.raises(SystemExit) as end, stopped_by_signals():
        work()
    assert (end.value.code, watched()) == (143, None)


@pytest.mark.parametrize(
    ("body", "code"), [("pass", 0), ("sys.exit(3)", 3), ("sys.exit('no')", 1), ("raise OSError", 1)]
)
def test_a_signal_after_the_end_does_not_change_the_exit_code(body, code):
    late = "import atexit, signal, sys; atexit.register(signal.raise_signal, signal.SIGTERM)\n"
    body = f"from metafem.cli.signals import stopped_by_signals\nwith stopped_by_signals(last=True): {body}"
    assert subprocess.run([sys.executable, "-c", late + body], capture_output=True).returncode == code


def test_a_shell_offers_the_contact_laws_that_begin_so(monkeypatch, capsys):
    monkeypatch.setenv("_METAFEM_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", "metafem design --contact j")
    monkeypatch.setenv("COMP_CWORD", "3")
    with pytest.raises(SystemExit) as end:
        cli.run()
    assert end.value.code == 0
    offered = [entry.partition(",")[2] for entry in capsys.readouterr().out.splitlines()]
    assert offered == ["jkr", "jackson-green"]


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_stopped_design_leaves_nothing(run, monkeypatch, number, code):
    Path("small.toml").write_text(demo_text("linear"), "utf-8")
    monkeypatch.setattr(Specification, "design", lambda *_: signal.raise_signal(number))
    before = [signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)]
    assert run("design", "small.toml", "-o", "out").exit_code == code
    assert [path.name for path in Path().iterdir()] == ["small.toml"]
    assert [signal.getsignal(each) for each in (signal.SIGINT, signal.SIGTERM)] == before


@pytest.mark.usefixtures("plain_reports")
def test_files_of_the_user_are_never_replaced(run):
    Path("small.toml").write_text(demo_text("linear"), "utf-8")
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
        assert "so it is not replaced" in run(*command).refusal
        assert Path(name).read_text() == "mine"
