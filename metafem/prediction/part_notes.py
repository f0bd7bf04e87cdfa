"""Notes on features of a surface that cannot be manufactured."""

from __future__ import annotations

import numpy as np
import scipy

from metafem.contact.cap_geometry import SPHERES, CapShape
from metafem.notes import Note
from metafem.surface import Surface


def part_notes(surface: Surface, shape: CapShape) -> list[Note]:
    """Return notes on features of the surface that cannot be manufactured."""
    height, radius, block = surface.height, surface.radius, surface.block
    most = shape.tallest(radius)
    low, high = int((height < 0.0).sum()), int((height > most).sum())
    buried = _overlapping_caps(surface, shape)
    if shape is SPHERES:
        too_high = "their radius", f"{float(radius.min()):g} mm, or use larger radii"
    else:
        too_high = "their profile is deep", f"{float(most.min()):.4g} mm, or give a wider profile"
    features = [
        (
            low,
            f"{low} of {surface.count} summits lie below the base plane, the lowest at "
            f"{float(height.min()):.4g} mm, and cannot be made as caps: raise them above 0 mm",
        ),
        (
            high,
            f"{high} of {surface.count} summits stand higher than {too_high[0]} and cannot be made as caps: "
            f"lower them to {too_high[1]}",
        ),
        (
            buried,
            f"the caps of {buried} {'pair' if buried == 1 else 'pairs'} of summits overlap on the base plane "
            "and cannot be made as separate caps: increase the pitch, or lower the summits",
        ),
    ]
    if block is not None:
        half = 0.5 * np.array([block.width, block.length])
        outside = int((np.abs(surface.position) > half).any(axis=1).sum())
        text = (
            f"{outside} of {surface.count} summits stand outside the block of {block.width:g} by "
            f"{block.length:g} mm, whose centre is at (0, 0): make it larger, or move them"
        )
        features.append((outside, text))
    return [Note(text) for count, text in features if count]


def _overlapping_caps(surface: Surface, shape: CapShape) -> int:
    """Return the number of pairs of caps that overlap."""
    height = np.clip(surface.height, 0.0, shape.tallest(surface.radius))
    foot = shape.foot_radius(height, surface.radius)
    tree = scipy.spatial.cKDTree(surface.position)
    pairs = tree.query_pairs(2.0 * float(foot.max()), output_type="ndarray")
    distance = np.hypot(*(surface.position[pairs[:, 0]] - surface.position[pairs[:, 1]]).T)
    return int((distance < foot[pairs].sum(axis=1)).sum())
