"""Notes on features of a surface that cannot be manufactured."""

from __future__ import annotations

import numpy as np

from metafem.caps import SPHERE
from metafem.models.interacting.influence import close_pairs
from metafem.notes import Note, information
from metafem.surface import Surface


def part_notes(surface: Surface) -> list[Note]:
    """Return notes on features of the surface that cannot be manufactured or differ in the part."""
    height, radius, block, count = surface.height, surface.radius, surface.block, surface.count
    most = surface.cap.tallest(radius)
    low, high, buried = (height < 0.0).sum(), (height > most).sum(), _overlapping_caps(surface)
    too_high = f"their profile is deep and cannot be made as caps: lower them to {float(most.min()):.4g} mm"
    wider = "give a wider profile"
    if surface.cap == SPHERE:
        too_high = f"their radius and cannot be made as caps: lower them to {float(radius.min()):g} mm"
        wider = "use larger radii"
    features = [
        (
            "summits below the base plane", low, ("min_height",),
            f"{low} of {count} summits lie below the base plane, the lowest at {height.min():.4g} mm, and "
            "cannot be made as caps: raise them above 0 mm",
        ),
        (
            "summits too high for caps", high, ("max_height", "radius"),
            f"{high} of {count} summits stand higher than {too_high}, or {wider}",
        ),
        (
            "overlapping pairs of caps", buried, ("pitch",),
            f"the caps of {buried} {'pair' if buried == 1 else 'pairs'} of summits overlap on the base plane "
            "and cannot be made as separate caps: increase the pitch, or lower the summits",
        ),
    ]  # fmt: skip
    if block is not None:
        outside = (2.0 * np.abs(surface.position) > [block.width, block.length]).any(axis=1).sum()
        text = (
            f"{outside} of {count} summits stand outside the block of {block.width:g} by {block.length:g} "
            "mm, whose centre is at (0, 0): make it larger, or move them"
        )
        features.append(("summits outside the block", outside, ("width", "length"), text))
    notes = [
        Note(text, quantity=quantity, value=int(number), bound=0.0, remedies=remedies)
        for quantity, number, remedies, text in features
        if number
    ]
    if block is not None and surface.cell is not None:
        period = f"the part has one period of {surface.cell.width:g} by {surface.cell.length:g} mm"
        notes.append(information(f"the law is that of an infinite surface; {period}"))
    return notes


def _overlapping_caps(surface: Surface) -> int:
    """Return the number of pairs of caps that overlap, among all periods if the surface has a cell."""
    height = np.clip(surface.height, 0.0, surface.cap.tallest(surface.radius))
    foot = surface.cap.foot_radius(height, surface.radius)
    i, j, distance = close_pairs(surface, 2.0 * float(foot.max()))
    return int((distance < foot[i] + foot[j]).sum())
