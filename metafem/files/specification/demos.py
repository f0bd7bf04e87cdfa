"""The specifications that come with the package."""

from __future__ import annotations

from importlib.resources import files

from metafem._given import printable
from metafem.errors import InvalidInput
from metafem.files.specification.models import suggestion

DEMOS = ("operating-points", "linear", "bilinear")


def demo_text(name: str) -> str:
    """Return the text of a specification to start from: operating-points, linear or bilinear."""
    if name not in DEMOS:
        raise InvalidInput(f'demo "{printable(name, 60)}" is unknown{suggestion(name, DEMOS)}')
    return (
        files("metafem.files.specification")
        .joinpath("demo_files", f"{name}.toml")
        .read_text(encoding="utf-8")
    )
