"""Paths, links, modules and commands that README, CONTRIBUTING and the guide name exist."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
GUIDE = sorted(str(path.relative_to(ROOT)) for path in (ROOT / "validation" / "guide").glob("*.md"))

# What a command writes, and git ignores.
WRITTEN = "validation/results/"


def text_of(page):
    return (ROOT / page).read_text("utf-8")


@pytest.mark.parametrize("page", ["README.md", ".github/CONTRIBUTING.md", "meshes/README.md", *GUIDE])
def test_named_paths_links_and_commands_exist(page):
    text = text_of(page)
    paths = re.findall(r"[`(]((?:metafem|tests|validation|meshes)/[\w./-]*)[`)]", text)
    modules = re.findall(r"`python -m ([\w.]+)", text)
    links = re.findall(r"\]\(((?!https?:)[^)#]+)", text)
    assert paths or modules or page in GUIDE
    assert [path for path in paths if not (ROOT / path).exists() and not path.startswith(WRITTEN)] == []
    assert [name for name in modules if importlib.util.find_spec(name) is None] == []
    assert [link for link in links if not ((ROOT / page).parent / link).exists()] == []


def test_table_of_modules_is_true():
    table = text_of("validation/guide/modules.md").split("| module | holds |")[1].split("\n\n")[0]
    names = {name for row in table.splitlines() for name in re.findall(r"`(\w+)`", row.partition(" | ")[0])}
    private = {path.stem for path in (ROOT / "metafem").glob("_*")}
    present = {path.stem for path in (ROOT / "metafem").iterdir() if path.suffix == ".py" or path.is_dir()}
    parts = {name for row in table.splitlines() for name in re.findall(r"`(\w+)`", row.partition(" | ")[2])}
    assert names - present == set()
    assert parts - {path.stem for path in (ROOT / "metafem").rglob("*")} == set()
    assert present - private - names == set()


def test_every_page_of_the_guide_is_linked():
    links = {
        Path(link).name
        for page in ("README.md", *GUIDE)
        for link in re.findall(r"\]\(([^)#:]+\.md)", text_of(page))
    }
    assert [page for page in GUIDE if Path(page).name not in links] == []


def test_pages_of_the_guide_are_short():
    """The rows of the tables of the proof are those of a run."""
    text = {
        page: re.sub(r"^\|.*" if "proof" in page else "$.", "", text_of(page), flags=re.M) for page in GUIDE
    }
    assert [page for page in GUIDE if len(text[page].split()) > 900] == []
