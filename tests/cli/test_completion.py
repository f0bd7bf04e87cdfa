"""Completion in a shell: commands, options and their choices."""

import pytest

from metafem import cli
from metafem.files import DEMOS, MODELS


@pytest.fixture
def completed(monkeypatch, capsys):
    """Return what a shell offers for the last word of a line."""

    def call(line):
        monkeypatch.setenv("_METAFEM_COMPLETE", "bash_complete")
        monkeypatch.setenv("COMP_WORDS", line)
        monkeypatch.setenv("COMP_CWORD", str(len(line.split(" ")) - 1))
        with pytest.raises(SystemExit):
            cli.run()
        return [entry.partition(",")[2] for entry in capsys.readouterr().out.splitlines()]

    return call


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("metafem de", ["demo", "design"]),
        ("metafem demo ", list(DEMOS)),
        ("metafem study fid", ["fidelity"]),
        ("metafem design --chord", ["--chord-error"]),
        ("metafem spec --sch", ["--schema"]),
        ("metafem design --model ", list(MODELS)),
        ("metafem predict --model la", ["layer"]),
        ("metafem design --contact j", ["jkr", "jackson-green"]),
    ],
)
def test_a_shell_offers_names(completed, line, offered):
    assert completed(line) == offered


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_every_shell_reads_its_script(monkeypatch, capsys, shell):
    monkeypatch.setenv("_METAFEM_COMPLETE", f"{shell}_source")
    with pytest.raises(SystemExit) as ended:
        cli.run()
    assert ended.value.code == 0
    assert f"_METAFEM_COMPLETE={shell}_complete" in capsys.readouterr().out
