"""The shapes of the caps of a surface, and what its mould has besides, as data for the pictures."""

from __future__ import annotations

from typing import Any

import numpy as np

from metafem._validate import IntArray
from metafem._values import MICROMETRES
from metafem.caps import Cap, Caps
from metafem.errors import InvalidInput
from metafem.explorer.answer import Answer
from metafem.surface import Surface

# Intervals of a meridian, and decimals of its lengths over the radius. On a hemisphere, the chords lie within
# 3e-4 of the radius, which is less than a pixel of the largest picture.
INTERVALS, DECIMALS = 32, 6

# Smallest height of a meridian over the radius, for a surface without a summit above the base plane.
LOWEST = 1e-3

NO_BLOCK = "the mould needs “Block” with its width, length and thickness"
NO_SURFACE = "the mould needs a surface"


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


def mould_data(answer: Answer) -> dict[str, Any]:
    """Return what the mould has besides the caps of the surface, in the coordinates of the part.

    ``thickness`` is that of the plate [mm], and ``alignment`` contains position, height [um], radius [mm] and
    kind of cap of the alignment asperities. If no mould can be made, only the ``problem`` is returned.
    """
    part = answer.part
    if part is None or isinstance(part, InvalidInput):
        return {"problem": answer.no_part or (NO_BLOCK if answer.current else answer.refused or NO_SURFACE)}
    whole, kind = part.surface, kind_of_cap(part.surface)
    return {
        "problem": "",
        "thickness": part.block.thickness + float(whole.height.max()),
        "alignment": [
            {
                "x": float(whole.position[i, 0]),
                "y": float(whole.position[i, 1]),
                "height": MICROMETRES * float(whole.height[i]),
                "radius": float(whole.radius[i]),
                "kind": int(kind[i]),
            }
            for i in range(part.asperities, whole.count)
        ],
    }
