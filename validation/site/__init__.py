"""The pages of the examples and of the programming interface."""

from __future__ import annotations

from pathlib import Path

from validation.site.api import write_api
from validation.site.examples import write_examples

__all__ = ["write_api", "write_examples", "write_site"]


def write_site(folder: Path) -> list[str]:
    """Write both into a folder and return the addresses of the pages in it."""
    return [*write_examples(folder), *write_api(folder)]
