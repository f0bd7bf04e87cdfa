"""Memory that a solver needs, compared with what is there before it is allocated."""

from __future__ import annotations

import os

from metafem.errors import InvalidInput


def require_memory(needed: float, what: str) -> None:
    """Raise InvalidInput where `needed` bytes exceed the machine's memory."""
    if not hasattr(os, "sysconf"):
        return
    there = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    if needed > there:
        raise InvalidInput(
            f"{what} would need {needed / 2**30:.1f} GiB of memory, and the machine has {there / 2**30:.1f}"
        )
