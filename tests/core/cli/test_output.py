"""How commands end: on poor terminals, into full files and with errors as data."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from metafem import cli
from metafem.files import demo_text


def started(*arguments, **changes):
    """Run a command in a new process."""
    command = [sys.executable, "-m", "metafem", *map(str, arguments)]
    environment = {**os.environ, **changes.pop("environment", {})}
    return subprocess.run(command, text=True, env=environment, stderr=subprocess.PIPE, **changes)


@pytest.fixture
def small(tmp_path, monkeypatch):
    """A specification of nine asperities in the working folder."""
    monkeypatch.chdir(tmp_path)
    text = demo_text("linear").replace("[8, 8]", "[3, 3]")
    Path("small.toml").write_text(text, "utf-8")
    return text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("encoding", "shown"), [("cp1252", "lambda = 5 \xb5m\xb2"), ("ascii", "lambda = 5 um^2")]
)
def test_a_terminal_without_greek_letters_gets_their_names(encoding, shown):
    code = (
        "from metafem.cli.output import printing\nwith printing():\n    print('\u03bb = 5 \xb5m\xb2 \u2603')"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONIOENCODING": encoding},
        capture_output=True,
        check=True,
    )
    assert done.stdout.decode(encoding).strip() == f"{shown} ?"


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [("spec",), ("--help",)])
def test_a_pipe_that_is_closed_ends_quietly(arguments):
    reading, writing = os.pipe()
    os.close(reading)
    done = started(*arguments, stdout=writing)
    os.close(writing)
    assert (done.returncode, done.stderr) == (1, "")


@pytest.mark.parametrize(
    ("arguments", "code", "kind", "words"),
    [
        (("design", "none.toml", "-o", "x", "--json"), 2, "InvalidInput", "none.toml: no such file"),
        (("design", "small.toml", "--json"), 2, "Usage", "Missing option"),
        (("predict", "x.csv", "--jsn", "--json"), 2, "Usage", "No such option"),
        (("design", "flat.toml", "-o", "x", "--json"), 1, "Infeasible", "slope 3 is not above the bound"),
    ],
)
def test_errors_are_json_with_the_option_json(small, arguments, code, kind, words):
    Path("flat.toml").write_text(small.replace("6.87", "3.0"), "utf-8")
    result = CliRunner().invoke(cli.main, arguments)
    assert (result.exit_code, result.stderr) == (code, "")
    error = json.loads(result.stdout)["error"]
    assert error["type"] == kind
    assert words in error["message"]
