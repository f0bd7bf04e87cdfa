"""The packages of the extra `docs`, which the pages of examples and of the reference need."""

from __future__ import annotations

from metafem._extras import refuse_missing


def refuse_missing_docs() -> None:
    """Raise InvalidInput, which names the extra, if the packages for these pages are not installed."""
    for package in ("pdoc", "pygments"):
        refuse_missing(package, "docs", "writing the pages of the examples and of the reference")
