"""The surface of an answer as data for the pictures, and edits of its sites."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem._validate import IntArray
from metafem._values import MICROMETRES
from metafem.caps import Cap, Caps
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.explorer.fields import with_unit
from metafem.explorer.law_data import numbers
from metafem.explorer.table import Table, section_of, with_values
from metafem.inversion import Design, DesignStatus
from metafem.inversion.result import misfit_text
from metafem.models.interacting.influence import nearest_distance
from metafem.surface import Surface


@dataclass(frozen=True)
class Asked:
    """The fixed heights and empty sites of a specification.

    Attributes
    ----------
    empty : frozenset of int
        Sites that stay empty.
    pinned : mapping of int to str
        Heights, as written in the table, of the sites whose heights are fixed.
    """

    empty: frozenset[int]
    pinned: Mapping[int, str]


def asked_sites(table: Table) -> Asked:
    """Return the fixed heights and empty sites in a table; entries of a wrong type are ignored."""
    section = section_of(table, "sites")
    heights = section.get("heights")
    pairs = zip(_numbers(section.get("pinned")), heights if isinstance(heights, list) else (), strict=False)
    return Asked(frozenset(_numbers(section.get("empty"))), {site: str(height) for site, height in pairs})


def with_sites(
    table: Table, pinned: Mapping[int, str], empty: Collection[int] = (), free: Collection[int] = ()
) -> Table:
    """Return the table with sites fixed at heights such as "150 um", empty, or free."""
    asked, changed = asked_sites(table), {*pinned, *empty, *free}
    kept = {site: height for site, height in asked.pinned.items() if site not in changed}
    heights = dict(sorted({**kept, **pinned}.items()))
    values = {
        "empty": [site + 1 for site in sorted((asked.empty - changed).union(empty))],
        "pinned": [site + 1 for site in heights],
        "heights": list(heights.values()),
    }
    return with_values(table, {f"sites.{name}": value or None for name, value in values.items()})


def edited(table: Table, design: Design | None, given: Any) -> Table:
    """Return the table after an edit of sites, `given` as {"action", "sites", "height"}.

    With the height "", the action "pin" fixes each site at its current height.
    """
    if design is None:
        raise InvalidInput("there is no surface yet whose sites could be changed")
    action, sites, typed = _checked(given, design.template.count)
    if action == "empty":
        return with_sites(table, {}, empty=sites)
    if action == "release":
        return with_sites(table, {}, free=sites)
    if typed:
        return with_sites(table, dict.fromkeys(sites, typed_height(typed)))
    shown = {site: kept_height(design, site) for site in sites}
    heights = {site: height for site, height in shown.items() if height is not None}
    if not heights:
        raise InvalidInput(
            "an empty site has no height that could be kept: type one, or let the design choose"
        )
    return with_sites(table, heights)


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
    return [each - 1 for each in given if type(each) is int] if isinstance(given, list) else []


# Intervals of a meridian, and decimals of its lengths over the radius. On a hemisphere, the chords lie within
# 3e-4 of the radius, which is less than a pixel of the largest picture.
INTERVALS, DECIMALS = 32, 6

# Smallest height of a meridian over the radius, for a surface without a summit above the base plane.
LOWEST = 1e-3


def cap_data(surface: Surface, height: float) -> list[dict[str, Any]]:
    """Return the meridians of the kinds of caps down to a height [mm], or to where the caps end.

    ``across`` contains distances from the axis, and ``depth`` depths below the summit: over the radius of the
    asperity if the cap is ``scaled``, otherwise in mm.
    """
    kinds = surface.cap.kinds if isinstance(surface.cap, Caps) else (surface.cap,)
    index = kind_of_cap(surface)
    return [
        _meridian(cap, height / float(surface.radius[index == k].min()) if cap.scaled else height)
        for k, cap in enumerate(kinds)
    ]


def kind_of_cap(surface: Surface) -> IntArray:
    """Return the index of the kind of each asperity's cap, (n,)."""
    cap = surface.cap
    return cap.index if isinstance(cap, Caps) else np.zeros(surface.count, dtype=np.int64)


def _meridian(cap: Cap, height: float) -> dict[str, Any]:
    one = np.ones(1)
    top = np.clip(height, LOWEST, cap.tallest(one))
    across, z = cap.rings(top, one, INTERVALS)
    return {
        "scaled": cap.scaled,
        "across": np.round(across[0], DECIMALS).tolist(),
        "depth": np.round(top - z[0], DECIMALS).tolist(),
    }


def layout_data(design: Design) -> dict[str, Any]:
    """Return the data that rarely change: sites, their smallest distance and block size, all in [mm].

    The distance of a single site is four radii.
    """
    template = design.template
    block, distance = template.block, nearest_distance(template)
    return {
        "x": numbers(template.position[:, 0]),
        "y": numbers(template.position[:, 1]),
        "spacing": distance if math.isfinite(distance) else 4.0 * float(template.radius[0]),
        "block": None if block is None else [block.width, block.length, block.thickness],
    }


def site_data(answer: Answer) -> dict[str, Any]:
    """Return the heights [um] and radii [mm] at the sites, None at sites without an asperity.

    ``pinned`` contains the fixed heights as written, by site; ``empty`` the sites that the specification
    leaves empty; ``limits`` the smallest and the largest height of the colour scale [um]; ``loads`` the
    smallest and the largest rescaled load of the law [mm^2]; ``modulus`` the composite modulus [MPa];
    ``caps`` the shapes of the caps, and ``cap`` the index of the shape at each site if there are several.
    """
    data: dict[str, Any] = message_data(answer)
    design = answer.design
    if design is None:
        return data
    asked = asked_sites(answer.state.known)
    heights = MICROMETRES * design.surface.height
    radii = np.unique(design.surface.radius)
    limits, count = design.limits, design.template.count
    low = min(MICROMETRES * limits.foot, float(heights.min()))
    high = max(MICROMETRES * (limits.offset + limits.max_height), float(heights.max()))
    caps = cap_data(design.surface, high / MICROMETRES)
    return data | {
        "caps": caps,
        "cap": at_sites(design, kind_of_cap(design.surface)) if len(caps) > 1 else None,
        "height": at_sites(design, heights),
        "radius": float(radii[0]) if len(radii) == 1 else at_sites(design, design.surface.radius),
        "pinned": {str(site): height for site, height in asked.pinned.items() if site < count},
        "empty": sorted(site for site in asked.empty if site < count),
        "limits": [low, high],
        "loads": design.law.rescaled_load[[0, -1]].tolist(),
        "modulus": design.surface.material.composite_modulus,
    }


def message_data(answer: Answer) -> dict[str, Any]:
    """Return the message about the surface, and whether the surface belongs to an earlier state."""
    old = answer.design is not None and not answer.current
    return {"number": answer.number, "message": message(answer), "old": old}


def message(answer: Answer) -> str:
    """Return the message about the surface, or "".

    The message states that there is no surface, that the surface belongs to an earlier state, or that it
    misses the target with the fixed and empty sites.
    """
    if answer.design is None:
        return "There is no surface yet." if answer.problems or answer.refusal else ""
    asked = asked_sites(answer.state.known)
    if answer.refusal or answer.problems:
        of_sites = [words for key, words in answer.problems.items() if key.startswith("sites")]
        reason = "\n".join(of_sites) or "The law states the reason."
        return f"These are the heights of the last surface that was found. {reason}"
    if (asked.empty or asked.pinned) and answer.design.status is DesignStatus.MISSED:
        return (
            f"With these sites kept or empty the target law is missed by {misfit_text(answer.design.misfit)}."
        )
    return ""


# Significant digits of values at the sites: finer than what is drawn and told of them.
DIGITS = 6


def at_sites(design: Design, values: ArrayLike) -> list[float | None]:
    """Return values at the asperities by site of the template, None at empty sites."""
    listed: list[float | None] = [None] * design.template.count
    for site, value in zip(design.sites.tolist(), numbers(np.asarray(values), DIGITS), strict=True):
        listed[site] = value
    return listed
