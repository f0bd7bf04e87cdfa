"""Fixed heights and empty sites in the text of a specification."""

from __future__ import annotations

import tomllib
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

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
        section = tomllib.loads(text).get("sites")
    except (tomllib.TOMLDecodeError, RecursionError):
        return Asked()
    if not isinstance(section, dict):
        return Asked()
    heights = section.get("heights")
    pairs = zip(_numbers(section.get("pinned")), heights if isinstance(heights, list) else (), strict=False)
    return Asked(frozenset(_numbers(section.get("empty"))), {site: str(height) for site, height in pairs})


def pinned_text(text: str, heights: Mapping[int, str]) -> str:
    """Return the text with the heights of sites fixed at quantities such as "150 um"."""
    asked = asked_sites(text)
    return _written(text, asked.empty - heights.keys(), {**asked.pinned, **heights})


def emptied_text(text: str, sites: Collection[int]) -> str:
    """Return the text with these sites empty."""
    asked = asked_sites(text)
    kept = {site: height for site, height in asked.pinned.items() if site not in sites}
    return _written(text, asked.empty.union(sites), kept)


def released_text(text: str, sites: Collection[int]) -> str:
    """Return the text in which the design chooses these sites: neither fixed nor empty."""
    asked = asked_sites(text)
    kept = {site: height for site, height in asked.pinned.items() if site not in sites}
    return _written(text, asked.empty.difference(sites), kept)


def _numbers(given: Any) -> list[int]:
    return [each for each in given if type(each) is int] if isinstance(given, list) else []


def _written(text: str, empty: Collection[int], pinned: Mapping[int, str]) -> str:
    sites = sorted(pinned)
    return Document(text).with_values(
        {
            "sites.empty": sorted(empty) or None,
            "sites.pinned": sites or None,
            "sites.heights": [pinned[site] for site in sites] or None,
        }
    )
