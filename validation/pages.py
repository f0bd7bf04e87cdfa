"""The frame of every page of the site: its templates, and the bar that leads to the other pages."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from metafem.report.html import render
from validation.chapters import CHAPTERS

TEMPLATES = Path(__file__).parent / "templates"

# Pages beside the report, which `python -m validation --site` writes.
BESIDE = (
    ("guide/start.html", "Guide"),
    ("examples/index.html", "Examples"),
    ("api/metafem.html", "API"),
)


def site_page(template: str, *, here: str, whole: bool = True, **values: Any) -> str:
    """Return a page of the site from a template of `validation/templates/` that extends site.html.

    `here` is the address of the page from the folder of the site, such as "examples/e01_hertz.html"; `whole`
    says whether the site has the guide, the examples and the reference, or the report alone.
    """
    chapters = [(f"{chapter.name}.html", short(chapter.name)) for chapter in CHAPTERS]
    root = "../" * here.count("/")
    bar = [*(BESIDE if whole else ()), *chapters]
    return render(template, TEMPLATES, here=here, root=root, bar=bar, whole=whole, **values)


def short(name: str) -> str:
    """Return the name of a chapter as words."""
    return name.replace("_", " ").capitalize()
