"""Progress on a terminal and without one."""

import time

from rich.console import Console

from metafem.cli import progress as module
from metafem.cli.progress import FIRST_LINE, NEXT_LINE, Lines, progress
from metafem.progress import doing, each, message


def test_short_work_prints_no_lines_and_long_work_few():
    lines = Lines(100.0)
    lines.step("solving, part 1 of 2", 0.0)
    assert lines.due(100.0 + 0.9 * FIRST_LINE) is None
    assert lines.due(100.0 + FIRST_LINE) == f"solving, part 1 of 2, 0 % ({FIRST_LINE:.0f} s)"
    lines.step("solving, part 2 of 2", 0.5)
    assert lines.due(100.0 + FIRST_LINE + 0.9 * NEXT_LINE) is None
    later = FIRST_LINE + NEXT_LINE
    assert lines.due(100.0 + later) == f"solving, part 2 of 2, 50 % ({later:.0f} s)"


def test_without_a_terminal_facts_are_lines_on_stderr(capsys):
    with progress(), doing("solving"):
        message("the solution is kept in /a folder")
    out, err = capsys.readouterr()
    assert (out, err) == ("", "the solution is kept in /a folder\n")


def test_a_line_is_printed_while_a_step_lasts(capsys, monkeypatch):
    monkeypatch.setattr(module, "LOOK", 0.001)
    monkeypatch.setattr(module, "FIRST_LINE", 0.0)
    monkeypatch.setattr(module, "NEXT_LINE", 0.0)  # a line that is printed while the output is read is lost
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
