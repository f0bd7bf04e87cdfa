"""Notes on features of a surface that cannot be manufactured."""

from __future__ import annotations

import numpy as np

from metafem.caps import SPHERE
from metafem.models.interacting.influence import close_pairs
from metafem.notes import Note, information
from metafem.surface import Surface


def part_notes(surface: Surface) -> list[Note]:
    """Return notes on features of the surface that cannot be manufactured or differ in the part."""
    height, radius, block = surface.height, surface.radius, surface.block
    most = surface.cap.tallest(radius)
    low, high = int((height < 0.0).sum()), int((height > most).sum())
    buried = _overlapping_caps(surface)
    if surface.cap == SPHERE:
        too_high = "their radius", f"{float(radius.min()):g} mm, or use larger radii"
    else:
        too_high = "their profile is deep", f"{float(most.min()):.4g} mm, or give a wider profile"
    features: list[tuple[str, int, tuple[str, ...], str]] = [
        (
            "summits below the base plane", low, ("min_height",),
            f"{low} of {surface.count} summits lie below the base plane, the lowest at "
            f"{float(height.min()):.4g} mm, and cannot be made as caps: raise them above 0 mm",
        ),
        (
            "summits too high for caps", high, ("max_height", "radius"),
            f"{high} of {surface.count} summits stand higher than {too_high[0]} and cannot be made as caps: "
            f"lower them to {too_high[1]}",
        ),
        (
            "overlapping pairs of caps", buried, ("pitch",),
            f"the caps of {buried} {'pair' if buried == 1 else 'pairs'} of summits overlap on the base plane "
            "and cannot be made as separate caps: increase the pitch, or lower the summits",
        ),
    ]  # fmt: skip
    if block is not None:
        half = 0.5 * np.array([block.width, block.length])
        outside = int((np.abs(surface.position) > half).any(axis=1).sum())
        text = (
            f"{outside} of {surface.count} summits stand outside the block of {block.width:g} by "
            f"{block.length:g} mm, whose centre is at (0, 0): make it larger, or move them"
        )
        features.append(("summits outside the block", outside, ("width", "length"), text))
    notes = [
        Note(text, quantity=quantity, value=count, bound=0.0, remedies=remedies)
        for quantity, count, remedies, text in features
        if count
    ]
    if block is not None and surface.cell is not None:
        sides = f"{surface.cell.width:g} by {surface.cell.length:g} mm"
        notes.append(
            information(f"the law is that of an infinite surface; the part has one period of {sides}")
        )
    return notes


def _overlapping_caps(surface: Surface) -> int:
    """Return the number of pairs of caps that overlap, among all periods if the surface has a cell."""
    height = np.clip(surface.height, 0.0, surface.cap.tallest(surface.radius))
    foot = surface.cap.foot_radius(height, surface.radius)
    i, j, distance = close_pairs(surface, 2.0 * float(foot.max()))
    return int((distance < foot[i] + foot[j]).sum())
