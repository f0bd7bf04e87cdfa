"""Edits of single sites that the user makes on the map."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.surface.sites_text import emptied_text, pinned_text, released_text
from metafem.explorer.surface.surface_data import kept_height
from metafem.inversion import Design

# A number without a unit; it is in micrometres.
NUMBER = re.compile(r"\d+\.?\d*|\.\d+")


def edited(text: str, design: Design | None, given: Any) -> str:
    """Return the text after an edit of sites, `given` as {"action", "sites", "height"}.

    With the height "", the action "pin" fixes each site at its current height.
    """
    if design is None:
        raise InvalidInput("there is no surface yet whose sites could be changed")
    action, sites, typed = _checked(given, design.template.count)
    if action == "empty":
        return emptied_text(text, sites)
    if action == "release":
        return released_text(text, sites)
    if typed:
        return pinned_text(text, dict.fromkeys(sites, typed_height(typed)))
    shown = {site: kept_height(design, site) for site in sites}
    heights = {site: height for site, height in shown.items() if height is not None}
    if not heights:
        raise InvalidInput(
            "an empty site has no height that could be kept: type one, or let the design choose"
        )
    return pinned_text(text, heights)


def typed_height(typed: str) -> str:
    """Return a typed height as a quantity; a number without a unit is in micrometres.

    Text that does not begin with a number raises InvalidInput. Other invalid quantities are reported when the
    specification is read.
    """
    words = typed.strip()
    if NUMBER.fullmatch(words):
        return f"{words} um"
    if not words[:1].isdigit() and not words.startswith("."):
        raise InvalidInput(f'height = "{words}" must be a number of micrometres, such as 150 or "0.15 mm"')
    return words


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
