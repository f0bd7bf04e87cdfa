"""Fixed heights and empty sites in the text of a specification, and edits of them on the map."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from metafem._values import MICROMETRES
from metafem.errors import InvalidInput
from metafem.explorer.text.document import Document, section_of
from metafem.explorer.text.fields import with_unit
from metafem.inversion import Design


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

    empty: frozenset[int]
    pinned: Mapping[int, str]


def asked_sites(text: str) -> Asked:
    """Return the fixed heights and empty sites in a text; entries of a wrong type are ignored."""
    section = section_of(text, "sites")
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


def edited(text: str, design: Design | None, given: Any) -> str:
    """Return the text after an edit of sites, `given` as {"action", "sites", "height"}.

    With the height "", the action "pin" fixes each site at its current height.
    """
    if design is None:
        raise InvalidInput("there is no surface yet whose sites could be changed")
    action, sites, typed = _checked(given, design.template.count)
    if action == "empty":
        return with_sites(text, {}, empty=sites)
    if action == "release":
        return with_sites(text, {}, free=sites)
    if typed:
        return with_sites(text, dict.fromkeys(sites, typed_height(typed)))
    shown = {site: kept_height(design, site) for site in sites}
    heights = {site: height for site, height in shown.items() if height is not None}
    if not heights:
        raise InvalidInput(
            "an empty site has no height that could be kept: type one, or let the design choose"
        )
    return with_sites(text, heights)


def typed_height(typed: str) -> str:
    """Return a typed height as a quantity; a number without a unit is in micrometres.

    Text that does not begin with a number raises InvalidInput. Other invalid quantities are reported when the
    specification is read.
    """
    words = with_unit(typed, "um")
    if not words[:1].isdigit() and not words.startswith("."):
        raise InvalidInput(f'height = "{words}" must be a number of micrometres, such as 150 or "0.15 mm"')
    return words


def kept_height(design: Design, site: int) -> str | None:
    """Return the height of a site as a quantity, rounded to 0.1 um within the limits; None if it is empty."""
    found = np.flatnonzero(design.sites == site)
    if not len(found):
        return None
    height = MICROMETRES * float(design.surface.height[found[0]])
    limits, tenths = design.limits, round(10.0 * height)
    if tenths > 10.0 * MICROMETRES * (limits.offset + limits.max_height) >= 10.0 * height:
        tenths -= 1
    elif tenths < 10.0 * MICROMETRES * limits.foot <= 10.0 * height:
        tenths += 1
    return f"{tenths / 10.0!r} um"


def _checked(given: Any, count: int) -> tuple[str, Sequence[int], str]:
    """Return action, sites and height from a browser event; raise InvalidInput if one is not valid."""
    try:
        action, sites, typed = given["action"], given["sites"], given["height"]
        known = action in ("pin", "empty", "release") and isinstance(typed, str)
        if known and sites and all(type(site) is int and 0 <= site < count for site in sites):
            return action, sites, typed
    except (KeyError, TypeError):
        pass
    raise InvalidInput("the sites have changed meanwhile; select them again")


def _numbers(given: Any) -> list[int]:
    return [each for each in given if type(each) is int] if isinstance(given, list) else []
