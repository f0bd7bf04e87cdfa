"""Progress on a terminal and without one."""

from rich.console import Console

from metafem.cli.output import progress
from metafem.progress import doing, each, message


def test_without_a_terminal_facts_are_lines_on_stderr(capsys):
    with progress(), doing("solving"):
        message("the solution is kept in /a folder")
    out, err = capsys.readouterr()
    assert (out, err) == ("", "the solution is kept in /a folder\n")


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
