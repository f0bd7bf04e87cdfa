"""Edits of single sites that the user makes on the map."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from metafem.errors import InvalidInput
from metafem.explorer.surface.sites_text import with_sites
from metafem.explorer.surface.surface_data import kept_height
from metafem.explorer.text.fields import with_points, with_unit
from metafem.inversion import Design


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
    words = with_unit(with_points(typed.strip()), "um")
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
