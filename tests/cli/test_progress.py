"""Progress on a terminal and without one."""

import threading
import time
from types import SimpleNamespace

from rich.console import Console

from metafem.cli import progress as module
from metafem.cli.progress import FIRST_LINE, NEXT_LINE, progress
from metafem.progress import doing, each, message


def test_long_work_prints_few_lines(monkeypatch):
    waited = []

    class Ended:
        def wait(self, seconds):
            waited.append(seconds)
            return len(waited) > 2

        def set(self):
            pass

    monkeypatch.setattr(module, "threading", SimpleNamespace(Thread=threading.Thread, Event=Ended))
    with progress():
        pass
    assert waited == [FIRST_LINE, NEXT_LINE, NEXT_LINE]


def test_without_a_terminal_facts_are_lines_on_stderr(capsys):
    with progress(), doing("solving"):
        message("the solution is kept in /a folder")
    out, err = capsys.readouterr()
    assert (out, err) == ("", "the solution is kept in /a folder\n")


def test_a_line_is_printed_while_a_step_lasts(capsys, monkeypatch):
    monkeypatch.setattr(module, "FIRST_LINE", 0.001)
    monkeypatch.setattr(module, "NEXT_LINE", 0.001)  # a line that is printed while the output is read is lost
    printed = ""
    with progress(), doing("factorising [a]"):
        end = time.monotonic() + 10.0
        while "factorising [a] (0 s)\n" not in printed and time.monotonic() < end:
            printed += capsys.readouterr().err
    assert "factorising [a] (0 s)\n" in printed


def test_a_terminal_shows_the_step_and_its_share(capsys, monkeypatch):
    terminal = Console(stderr=True, force_terminal=True, width=100)
    monkeypatch.setattr("rich.console.Console", lambda **_: terminal)
    with progress():
        for _ in each("load", [1, 2]):
            for live in terminal._live_stack:  # which another thread draws now and then
                live.refresh()
    out, err = capsys.readouterr()
    assert out == ""
    assert "load 2 of 2, 50 %" in err


def test_kernels_that_cannot_be_kept_are_reported(tmp_path, monkeypatch):
    (tmp_path / "file").touch()
    monkeypatch.setenv("METAFEM_CACHE_DIR", str(tmp_path))
    assert module._how_often() == "once for this installation"
    monkeypatch.setenv("METAFEM_CACHE_DIR", str(tmp_path / "file"))
    assert module._how_often().startswith("again for each command, because the cache cannot be written")
