"""How commands end: on poor terminals, into full files and with errors as data."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

import metafem as mf
from metafem import cli
from metafem.cli.output import PLAIN
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


def test_replacements_of_characters_are_ascii():
    assert all(text.isascii() for text in PLAIN.values())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no /dev/full")
@pytest.mark.parametrize("arguments", [("--help",), pytest.param(("spec", "--json"), marks=pytest.mark.slow)])
def test_a_full_output_is_reported(arguments):
    with open("/dev/full", "w") as full:
        done = started(*arguments, stdout=full)
    assert done.returncode == 1
    assert done.stderr == "Error: the output cannot be written: No space left on device\n"


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


def test_errors_are_text_without_the_option_json(small):
    result = CliRunner().invoke(cli.main, ["design", "none.toml", "-o", "x"])
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr.startswith("Error: none.toml: no such file")


def test_a_layer_without_a_block_is_refused_for_a_folder(small):
    template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    mf.save(mf.design(mf.OperatingPoints([0.01], [0.1]), template), "bare")
    result = CliRunner().invoke(cli.main, ["predict", "bare", "--model", "layer"])
    assert (result.exit_code, "design it again with a section [block]" in result.stderr) == (2, True)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--composite-modulus", "-1 kPa"), "--composite-modulus = -1 kPa must be greater than 0 kPa"),
        (("--composite-modulus", "1 MPa", "--radius", "-5 um"), "--radius = -5 um must be greater"),
        (("--composite-modulus", "1 MPa", "--radius", "1,5 mm"), "--radius = .* write decimals with a point"),
    ],
)
def test_errors_name_options(small, options, words):
    Path("t.csv").write_text("x_mm,y_mm,height_um\n0,0,5\n", "utf-8")
    result = CliRunner().invoke(cli.main, ["predict", "t.csv", *options])
    assert result.exit_code == 2
    assert re.search(words, result.stderr)
