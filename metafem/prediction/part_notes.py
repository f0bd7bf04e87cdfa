"""Notes on features of a surface that cannot be manufactured."""

from __future__ import annotations

import numpy as np
import scipy

from metafem.contact.cap_geometry import SPHERES, CapShape
from metafem.notes import Note
from metafem.surface import Surface


def part_notes(surface: Surface, shape: CapShape) -> list[Note]:
    """Return notes on features of the surface that cannot be manufactured."""
    notes = []
    low = int((surface.height < 0.0).sum())
    if low:
        notes.append(
            Note(
                f"{low} of {surface.count} summits lie below the base plane, the lowest at "
                f"{float(surface.height.min()):.4g} mm, and cannot be made as caps: raise them above 0 mm"
            )
        )
    most = shape.tallest(surface.radius)
    high = int((surface.height > most).sum())
    if high and shape is not SPHERES:
        notes.append(
            Note(
                f"{high} of {surface.count} summits stand higher than their profile is deep and cannot be "
                f"made as caps: lower them to {float(most.min()):.4g} mm, or give a wider profile"
            )
        )
    elif high:
        notes.append(
            Note(
                f"{high} of {surface.count} summits stand higher than their radius and cannot be made as "
                f"caps: lower them to {float(surface.radius.min()):g} mm, or use larger radii"
            )
        )
    buried = _overlapping_caps(surface, shape)
    if buried:
        notes.append(
            Note(
                f"the caps of {buried} {'pair' if buried == 1 else 'pairs'} of summits overlap on the base "
                "plane and cannot be made as separate caps: increase the pitch, or lower the summits"
            )
        )
    block = surface.block
    if block is not None:
        outside = np.abs(surface.position) > 0.5 * np.array([block.width, block.length])
        count = int(outside.any(axis=1).sum())
        if count:
            notes.append(
                Note(
                    f"{count} of {surface.count} summits stand outside the block of {block.width:g} by "
                    f"{block.length:g} mm, whose centre is at (0, 0): make it larger, or move them"
                )
            )
    return notes


def _overlapping_caps(surface: Surface, shape: CapShape) -> int:
    """Return the number of overlapping pairs of caps."""
    height = np.clip(surface.height, 0.0, shape.tallest(surface.radius))
    foot = shape.foot_radius(height, surface.radius)
    tree = scipy.spatial.cKDTree(surface.position)
    pairs = tree.query_pairs(2.0 * float(foot.max()), output_type="ndarray")
    distance = np.hypot(*(surface.position[pairs[:, 0]] - surface.position[pairs[:, 1]]).T)
    return int((distance < foot[pairs].sum(axis=1)).sum())
