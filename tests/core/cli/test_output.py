"""How commands end: into a closed pipe, and with errors as data."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from metafem.files import demo_text


@pytest.mark.slow
@pytest.mark.parametrize("arguments", [("spec",), ("--help",)])
def test_a_pipe_that_is_closed_ends_quietly(arguments):
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "metafem", *arguments]
    done = subprocess.run(command, text=True, stderr=subprocess.PIPE, stdout=writing)
    os.close(writing)
    assert (done.returncode, done.stderr) == (1, "")


@pytest.mark.parametrize(
    ("arguments", "code", "kind", "words"),
    [
        (("design", "none.toml", "-o", "x", "--json"), 2, "InvalidInput", "none.toml: no such file"),
        (("design", "flat.toml", "--json"), 2, "Usage", "Missing option"),
        (("predict", "x.csv", "--jsn", "--json"), 2, "Usage", "No such option"),
        (("design", "flat.toml", "-o", "x", "--json"), 1, "Infeasible", "slope 3 is not above the bound"),
    ],
)
def test_errors_are_json_with_the_option_json(run, arguments, code, kind, words):
    Path("flat.toml").write_text(demo_text("linear").replace("6.87", "3.0"), "utf-8")
    result = run(*arguments)
    assert (result.exit_code, result.stderr) == (code, "")
    error = json.loads(result.stdout)["error"]
    assert error["type"] == kind
    assert words in error["message"]
