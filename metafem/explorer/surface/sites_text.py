"""Fixed heights and empty sites in the text of a specification."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.text.document import Document


@dataclass(frozen=True)
class Asked:
    """The fixed heights and empty sites of a specification.

    Attributes
    ----------
    empty : frozenset of int
        Sites that stay empty.
    pinned : mapping of int to str
        Heights, as written in the text, of the sites whose heights are fixed.
    """

    empty: frozenset[int] = frozenset()
    pinned: Mapping[int, str] = field(default_factory=dict)


def asked_sites(text: str) -> Asked:
    """Return the fixed heights and empty sites in a text; entries of a wrong type are ignored."""
    try:
        section = Document(text).section("sites")
    except InvalidInput:
        return Asked()
    heights = section.get("heights")
    pairs = zip(_numbers(section.get("pinned")), heights if isinstance(heights, list) else (), strict=False)
    return Asked(frozenset(_numbers(section.get("empty"))), {site: str(height) for site, height in pairs})


def with_sites(
    text: str, pinned: Mapping[int, str], empty: Collection[int] = (), free: Collection[int] = ()
) -> str:
    """Return the text with sites fixed at heights such as "150 um", empty, or free."""
    asked, changed = asked_sites(text), {*pinned, *empty, *free}
    kept = {site: height for site, height in asked.pinned.items() if site not in changed}
    heights = dict(sorted({**kept, **pinned}.items()))
    values = {
        "empty": sorted((asked.empty - changed).union(empty)),
        "pinned": list(heights),
        "heights": list(heights.values()),
    }
    return Document(text).with_values({f"sites.{name}": value or None for name, value in values.items()})


def _numbers(given: Any) -> list[int]:
    return [each for each in given if type(each) is int] if isinstance(given, list) else []
