"""Check that the packages of optional extras are installed."""

from __future__ import annotations

from importlib.util import find_spec

from metafem.errors import refuse_if


def refuse_missing(package: str, extra: str, purpose: str) -> None:
    """Raise InvalidInput, naming the extra and its purpose, if a package of the extra is not installed."""
    refuse_if(
        find_spec(package) is None, f"{purpose} needs the extra {extra}: pip install 'metafem[{extra}]'"
    )
