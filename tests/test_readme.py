"""The README's Python runs and prints what it says."""

import contextlib
import io
import re
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from metafem import _caches, cli

README = (Path(__file__).parent.parent / "README.md").read_text("utf-8")


def test_printed_output_is_what_the_example_prints():
    code = re.search(r"```python\n(.*?)```", README, re.S).group(1)
    output = re.search(r"```text\n(.*?)```", README, re.S).group(1)
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(code, "README.md", "exec"), {})
    assert printed.getvalue() == output


@pytest.mark.slow
def test_studies_print_the_answers_that_it_shows(demo_results, tmp_path, monkeypatch):
    section = README.split("## How exact must the part be")[1].split("\n## ")[0]
    commands = re.search(r"```bash\n(.*?)```", section, re.S).group(1).splitlines()
    text = re.search(r"```text\n(.*?)```", section, re.S).group(1)
    answers = text.replace("\n  ", " ").splitlines()  # long lines are continued
    folder, _ = demo_results("linear")
    monkeypatch.setattr(_caches, "study_folder", lambda: tmp_path / "studies")
    shutil.copytree(folder / "linear", tmp_path / "linear")
    monkeypatch.chdir(tmp_path)
    for command, answer in zip(commands, answers, strict=True):
        result = CliRunner().invoke(cli.main, command.split()[1:])
        assert result.exit_code == 0, result.output
        assert answer in result.stdout.splitlines()
