"""The pages of the guide, of the examples and of the programming interface."""

from __future__ import annotations

from pathlib import Path

from validation.site.api import write_api
from validation.site.examples import write_examples
from validation.site.guide import guide, write_guide

__all__ = ["write_api", "write_examples", "write_guide", "write_site"]


def write_site(folder: Path) -> list[str]:
    """Write all into a folder and return the addresses of the pages in it."""
    write_guide(folder)
    written = [f"guide/{page.name}.html" for page in guide()]
    return [*written, *write_examples(folder), *write_api(folder)]
