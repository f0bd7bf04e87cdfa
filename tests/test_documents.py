"""Paths, links, modules and commands that README, CONTRIBUTING and the guide name exist."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
GUIDE = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "validation" / "guide").glob("*.md"))
PAGES = ["README.md", ".github/CONTRIBUTING.md", "meshes/README.md", *GUIDE]

# What a command writes, and git ignores.
WRITTEN = "validation/results/"


@pytest.mark.parametrize("page", PAGES)
def test_named_paths_exist(page):
    text = (ROOT / page).read_text("utf-8")
    paths = re.findall(r"[`(]((?:metafem|tests|validation|meshes)/[\w./-]*)[`)]", text)
    assert paths or page in GUIDE
    assert [path for path in paths if not (ROOT / path).exists() and not path.startswith(WRITTEN)] == []


@pytest.mark.parametrize("page", PAGES)
def test_named_commands_exist(page):
    text = (ROOT / page).read_text("utf-8")
    modules = set(re.findall(r"`python -m ([\w.]+)", text))
    assert modules or page in GUIDE
    assert [name for name in modules if importlib.util.find_spec(name) is None] == []


def test_table_of_modules_is_true():
    table = (
        (ROOT / "validation/guide/modules.md")
        .read_text("utf-8")
        .split("| module | holds |")[1]
        .split("\n\n")[0]
    )
    names = {name for row in table.splitlines() for name in re.findall(r"`(\w+)`", row.partition(" | ")[0])}
    private = {path.stem for path in (ROOT / "metafem").glob("_*")}
    present = {path.stem for path in (ROOT / "metafem").iterdir() if path.suffix == ".py" or path.is_dir()}
    assert names - present == set()
    assert present - private - names == set()


@pytest.mark.parametrize("page", PAGES)
def test_local_links_lead_to_files(page):
    text = (ROOT / page).read_text("utf-8")
    links = re.findall(r"\]\(((?!https?:)[^)#]+)", text)
    assert [link for link in links if not ((ROOT / page).parent / link).exists()] == []


def test_readme_links_every_page_of_the_guide():
    links = re.findall(r"\]\((validation/guide/[^)#]+)", (ROOT / "README.md").read_text("utf-8"))
    assert sorted(set(links)) == GUIDE
