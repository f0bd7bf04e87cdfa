"""Packages of optional extras."""

from __future__ import annotations

from importlib.util import find_spec

from metafem.errors import refuse_if


def refuse_missing(package: str, extra: str, purpose: str) -> None:
    """Raise InvalidInput with the name and purpose of the extra if one of its packages is not installed."""
    refuse_if(
        find_spec(package) is None, f"{purpose} needs the extra {extra}: pip install 'metafem[{extra}]'"
    )
