"""Every command that reads a result folder tells what was changed in it."""

import json
from pathlib import Path

import pytest

import metafem as mf

pytestmark = pytest.mark.usefixtures("plain_reports")


@pytest.fixture
def changed(run):
    """Return a result folder with a changed height and a changed table."""
    template = mf.Surface.square_lattice(0.2, (4, 4), radius=0.526, material=mf.Material(1.36))
    mf.save(mf.design(mf.OperatingPoints([0.02, 0.05], [0.2, 0.45]), template), "out")
    path = Path("out", "design.json")
    record = json.loads(path.read_text())
    heights = record["design"]["surface"]["height"]["float64"]
    heights[heights.index(max(heights))] += 0.03
    path.write_text(json.dumps(record))
    Path("out", "heights.csv").write_text("mine")
    return "out"


@pytest.mark.parametrize("command", [("predict",), ("study", "interaction"), ("report",)])
def test_what_was_changed_is_told_by_every_command(run, changed, command):
    result = run(*command, changed, "--json")
    found = [note["text"] for note in result.data["notes"] if note["level"] == "warning"]
    for name in ("design.json", "heights.csv"):
        (text,) = (each for each in found if f"{name} was changed since metafem wrote it" in each)
        assert f"warning: {text}" in result.stderr
    if command == ("report",):
        page = Path(changed, "report.html").read_text(encoding="utf-8")
        assert all(f"{name} was changed since metafem" in page for name in ("design.json", "heights.csv"))
