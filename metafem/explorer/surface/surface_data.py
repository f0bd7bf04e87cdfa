"""The surface of an answer as data for the pictures."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem._values import MICROMETRES
from metafem.explorer.answer import Answer
from metafem.explorer.surface.cap_data import cap_data, kind_of_cap, mould_data
from metafem.explorer.surface.sites_text import asked_sites
from metafem.inversion import Design, DesignStatus
from metafem.inversion.result import misfit_text
from metafem.models.interacting.influence import nearest_distance

# Decimals of heights [um] and positions [mm]. One unit of the last decimal is smaller than a pixel.
HEIGHT_DECIMALS, POSITION_DECIMALS = 2, 4


def layout_data(design: Design) -> dict[str, Any]:
    """Return the data that rarely change: sites, their smallest distance and block size, all in [mm].

    The distance of a single site is four radii.
    """
    template = design.template
    block, distance = template.block, nearest_distance(template)
    return {
        "x": _rounded(template.position[:, 0], POSITION_DECIMALS),
        "y": _rounded(template.position[:, 1], POSITION_DECIMALS),
        "spacing": distance if math.isfinite(distance) else 4.0 * float(template.radius[0]),
        "block": None if block is None else [block.width, block.length, block.thickness],
    }


def site_data(answer: Answer) -> dict[str, Any]:
    """Return the heights [um] and radii [mm] at the sites, None at sites without an asperity.

    ``pinned`` contains the fixed heights as written, by site; ``empty`` the sites that the specification
    leaves empty; ``limits`` the smallest and the largest height of the colour scale [um]; ``loads`` the
    smallest and the largest rescaled load of the law [mm^2]; ``modulus`` the composite modulus [MPa];
    ``caps`` the shapes of the caps, and ``cap`` the index of the shape at each site if there are several. A
    full answer has the ``mould``.
    """
    data: dict[str, Any] = message_data(answer)
    design = answer.design
    if design is None:
        return data
    asked = asked_sites(answer.state.text)
    heights = MICROMETRES * design.surface.height
    radii = np.unique(design.surface.radius)
    limits, count = design.limits, design.template.count
    low = min(MICROMETRES * limits.foot, float(heights.min()))
    high = max(MICROMETRES * (limits.offset + limits.max_height), float(heights.max()))
    specification = answer.specification
    alignment = None if specification is None else specification.part.alignment_height
    caps = cap_data(design.surface, max(high / MICROMETRES, alignment or 0.0))
    return data | {
        **({} if answer.draft else {"mould": mould_data(answer)}),
        "caps": caps,
        "cap": at_sites(design, kind_of_cap(design.surface), 0) if len(caps) > 1 else None,
        "height": at_sites(design, heights, HEIGHT_DECIMALS),
        "radius": float(radii[0]) if len(radii) == 1 else at_sites(design, design.surface.radius, 4),
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
    asked = asked_sites(answer.state.text)
    if answer.refusal or answer.problems:
        of_sites = [words for key, words in answer.problems.items() if key.startswith("sites")]
        reason = "\n".join(of_sites) or "The reason is given in the plot of the law."
        return f"These are the heights of the last surface that was found. {reason}"
    if (asked.empty or asked.pinned) and answer.design.status is DesignStatus.MISSED:
        return (
            f"With these sites kept or empty the target law is missed by {misfit_text(answer.design.misfit)}."
        )
    return ""


def at_sites(design: Design, values: ArrayLike, decimals: int) -> list[float | None]:
    """Return values at the asperities by site of the template, None at empty sites."""
    listed: list[float | None] = [None] * design.template.count
    for site, value in zip(design.sites.tolist(), _rounded(values, decimals), strict=True):
        listed[site] = value
    return listed


def _rounded(values: ArrayLike, decimals: int) -> list[float]:
    return np.round(np.asarray(values, dtype=float), decimals).tolist()  # type: ignore[no-any-return]
