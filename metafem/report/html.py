"""The templates of the pages, which other packages can extend with folders of their own templates."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from jinja2 import Environment

# Headings that the contents of a page list: second-level headings with an anchor.
HEADING = re.compile(r'<h2 id="([^"]+)">(.*?)</h2>', re.DOTALL)


def render(template: str, folder: Path | None = None, **values: Any) -> str:
    """Return a filled template from this package, or from a folder of templates that extend its templates."""
    return _environment(folder).get_template(template).render(**values)


def headings(body: str) -> list[tuple[str, str]]:
    """Return anchors and texts of the sections of a page."""
    return [(found[1], re.sub(r"<[^>]+>", "", found[2])) for found in HEADING.finditer(body)]


@cache
def _environment(folder: Path | None) -> Environment:
    from jinja2 import ChoiceLoader, Environment, FileSystemLoader, PackageLoader, StrictUndefined

    own = PackageLoader("metafem.report")
    loader = own if folder is None else ChoiceLoader([FileSystemLoader(folder), own])
    environment = Environment(
        autoescape=True, loader=loader, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters["headings"] = headings
    return environment
