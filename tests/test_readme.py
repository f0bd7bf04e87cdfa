"""The Python and the commands of the README and of the guide run and print what they say."""

import contextlib
import io
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from metafem import cli
from metafem.drawing import svg
from metafem.files import demo_text, read_spec
from validation import laboratory

ROOT = Path(__file__).parent.parent
README = (ROOT / "README.md").read_text("utf-8")


def guide(name):
    """The text of a page of the guide."""
    return (ROOT / "validation" / "guide" / f"{name}.md").read_text("utf-8")


def without(text, *patterns):
    for pattern in patterns:
        text = re.sub(pattern, "", text, flags=re.S)
    return text


# What is read: no code blocks, no pictures, no addresses of links, no rules of tables.
READ = without(README, r"```.*?```", r"!\[[^]]*\]\([^)]*\)", r"(?<=\])\([^)]*\)", r"\|[-|]+\n")


def test_readme_is_short():
    assert len(re.findall(r"\S*\w\S*", READ)) <= 700
    cells = [cell for row in READ.splitlines() if row.startswith("|") for cell in row.split("|")]
    assert max(len(cell.split()) for cell in cells) <= 20
    assert len((ROOT / "CHANGELOG.md").read_bytes()) <= 3000


def test_numbers_of_the_readme_are_those_of_the_proof_or_of_the_checks():
    number = r"(?<![\w.])\d[\d,.]*\b"
    times = READ.partition("## Two commands")[2].partition("## In Python")[0]  # `.ci/run` prints them
    citation = READ.partition("[Aymard")[2].partition("]")[0]
    known = re.findall(number, guide("proof") + times + citation)
    assert set(re.findall(number, READ)) - set(known) == set()
    pyproject = (ROOT / "pyproject.toml").read_text("utf-8")
    assert re.findall(r"Python 3\.(\d+) to 3\.(\d+)", times) == [("11", "13")]
    assert re.findall(r"Python :: 3\.(\d+)", pyproject) == ["11", "12", "13"]


def test_models_of_the_readme_are_rows_of_the_proof():
    rows = {row.split(" | ")[0]: row for row in guide("proof").splitlines() if row.startswith("| `")}
    ours = [row.strip("| ").split(" | ") for row in READ.splitlines() if row.startswith("| `")]
    assert len(ours) == 5
    for name, _, one_load, error in ours:
        shown = rows[f"| {name}"].split(" | ")
        assert (one_load, error) == (shown[2], shown[4])


def test_the_example_prints_its_output_and_draws_its_picture():
    """Delete the picture, and it is drawn anew."""
    code = re.search(r"```python\n(.*?)```", README, re.S).group(1)
    output = re.search(r"```text\n(.*?)```", README, re.S).group(1)
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        exec(compile(code, "README.md", "exec"), names := {})
    assert printed.getvalue() == output
    figure = names["design"].plot().figure
    drawn = svg(figure, "Friction law of the design of the README on its target")
    picture = ROOT / "validation" / "first_design.svg"
    if not picture.exists():
        picture.write_text(drawn, "utf-8")
    number = r"-?\d+\.\d+"
    now, stored = (np.array(re.findall(number, text), float) for text in (drawn, picture.read_text("utf-8")))
    np.testing.assert_allclose(now, stored, rtol=0, atol=1.0)  # a pixel


def test_sites_of_the_guide_are_those_of_a_design(tmp_path):
    sites = re.search(r"```toml\n(.*?)```", guide("design"), re.S).group(1)
    path = tmp_path / "spec.toml"
    path.write_text(demo_text("linear") + sites, "utf-8")
    result = read_spec(path).design()
    heights = dict(zip((result.sites + 1).tolist(), result.surface.height.tolist(), strict=True))
    assert {site: heights.get(site) for site in (3, 17, 9, 12)} == {3: None, 17: None, 9: 0.15, 12: 0.12}


def test_studies_print_the_answers_that_it_shows(demo_results, tmp_path, monkeypatch):
    section = guide("tolerances")
    commands = re.search(r"```bash\n(.*?)```", section, re.S).group(1).splitlines()
    text = re.search(r"```text\n(.*?)```", section, re.S).group(1)
    answers = text.replace("\n  ", " ").splitlines()  # long lines are continued
    folder, _ = demo_results("linear")
    shutil.copytree(folder / "linear", tmp_path / "linear")
    monkeypatch.chdir(tmp_path)
    for command, answer in zip(commands, answers, strict=True):
        result = CliRunner().invoke(cli.main, command.split()[1:])
        assert result.exit_code == 0, result.output
        assert answer in result.stdout.splitlines()


@pytest.mark.nightly
def test_measurements_print_what_it_shows(tmp_path, monkeypatch):
    section = guide("measurements")
    blocks = re.findall(r"```bash\n(.*?)```\n\n```text\n(.*?)```", section, re.S)
    monkeypatch.chdir(tmp_path)
    runner = CliRunner(env={"COLUMNS": "200"})
    assert runner.invoke(laboratory.main, ["lab"]).exit_code == 0
    for commands, shown in blocks:
        printed = []
        for command in commands.splitlines():
            result = runner.invoke(cli.main, shlex.split(command)[1:])
            assert result.exit_code == 0, result.output
            printed += [" ".join(line.split()) for line in result.stdout.splitlines()]
            if command.startswith("metafem calibrate"):
                Path("part.toml").write_text(
                    Path("calibration.toml").read_text() + Path("lab/wanted.toml").read_text()
                )
            if command.startswith("metafem design"):
                assert runner.invoke(laboratory.main, ["lab", "--part", "part"]).exit_code == 0
        assert [line for line in shown.splitlines() if " ".join(line.split()) not in printed] == []
