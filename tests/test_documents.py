"""Paths, modules and commands that README and CONTRIBUTING name exist."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = ["README.md", ".github/CONTRIBUTING.md", "meshes/README.md"]


@pytest.mark.parametrize("page", PAGES)
def test_named_paths_exist(page):
    text = (ROOT / page).read_text("utf-8")
    paths = re.findall(r"[`(]((?:metafem|tests|validation|meshes)/[\w./-]*)[`)]", text)
    assert paths
    assert [path for path in paths if not (ROOT / path).exists()] == []


@pytest.mark.parametrize("page", PAGES)
def test_named_commands_exist(page):
    text = (ROOT / page).read_text("utf-8")
    modules = set(re.findall(r"`python -m ([\w.]+)", text))
    assert modules
    assert [name for name in modules if importlib.util.find_spec(name) is None] == []


def test_table_of_modules_is_true():
    table = (ROOT / "README.md").read_text("utf-8").split("| module | holds |")[1].split("\n\n")[0]
    names = {name for row in table.splitlines() for name in re.findall(r"`(\w+)`", row.partition(" | ")[0])}
    private = {path.stem for path in (ROOT / "metafem").glob("_*")}
    present = {path.stem for path in (ROOT / "metafem").iterdir() if path.suffix == ".py" or path.is_dir()}
    assert names - present == set()
    assert present - private - names == set()
