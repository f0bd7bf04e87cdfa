"""Commands that are stopped, and files of the user."""

import signal
import subprocess
import sys
import threading
import weakref
from pathlib import Path

import pytest
from click.testing import CliRunner

from metafem import cli
from metafem.cli.signals import stopped_by_signals
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


def test_an_ignored_signal_stays_ignored():
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with stopped_by_signals():
            signal.raise_signal(signal.SIGINT)
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


def test_a_signal_in_the_callback_of_a_weak_reference_is_not_lost(capsys):
    class Thing:
        pass

    things = [Thing()]
    watched = weakref.ref(things[0], lambda _: signal.raise_signal(signal.SIGTERM))

    def work(things):
        things.clear()
        threading.Event().wait(10.0)
        pytest.fail("the signal did not end what the command waited for")

    with pytest.raises(SystemExit) as end, stopped_by_signals():
        work(things)
    assert (end.value.code, watched()) == (143, None)
    assert capsys.readouterr().err == ""


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


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_command_that_is_stopped_during_its_import_reports_it(number, code, capsys):
    class Stop:
        def find_spec(self, name, path=None, target=None):
            if name == "metafem.cli.commands":
                signal.raise_signal(number)

    kept = {name: sys.modules.pop(name) for name in [*sys.modules] if name == "metafem.cli.commands"}
    sys.meta_path.insert(0, finder := Stop())
    try:
        with pytest.raises(SystemExit) as end:
            cli.run()
    finally:
        sys.meta_path.remove(finder)
        sys.modules.update(kept)
    assert end.value.code == code
    assert capsys.readouterr().err == "stopped; nothing was written\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize(("body", "code"), [("pass", 0), ("sys.exit(3)", 3), ("raise OSError", 1)])
def test_a_signal_after_the_end_does_not_change_the_exit_code(body, code, number):
    late = f"import atexit, signal, sys; atexit.register(signal.raise_signal, signal.{number.name})\n"
    body = f"from metafem.cli.signals import stopped_by_signals\nwith stopped_by_signals(last=True): {body}"
    done = subprocess.run([sys.executable, "-c", late + body], capture_output=True)
    assert done.returncode == code


def test_the_entry_point_handles_signals_before_other_imports():
    code = "import metafem.cli, sys; print(sorted({'click', 'json', 'metafem.cli.group'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
