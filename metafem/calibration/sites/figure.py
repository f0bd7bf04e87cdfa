"""The picture of what was found in an image."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from metafem.calibration.images.contact_areas import ContactAreas
from metafem.calibration.sites.tracked_contacts import TrackedContacts
from metafem.drawing import contacts as drawing

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def found_figure(
    image: NDArray[Any], areas: ContactAreas, tracked: TrackedContacts, index: int, sheared: bool = False
) -> Figure:
    """Return a figure of an image of a stack with its contacts, their numbers and the open sites."""
    placed = (tracked.placed_sheared if sheared else tracked.placed)[index]
    pixel = areas.pixel_size
    figure = drawing.picture_figure(*image.shape[::-1])
    ax = figure.add_subplot()
    drawing.picture(ax, image, pixel)
    measured = np.zeros(areas.count, dtype=bool) if placed is None else placed.site >= 0
    flagged = ~areas.complete
    for which, colour, label in (
        (measured & ~areas.saturated, drawing.MEASURED, "measured"),
        (flagged | (measured & areas.saturated), drawing.FLAGGED, "at the edge, merged or saturated"),
        (~measured & ~flagged, drawing.STRAY, "of no site"),
    ):
        drawing.outlines(ax, areas.centre[which], areas.axes[which], areas.angle[which], colour, label)
    if placed is not None:
        table = tracked.table
        number = table.site if table.matched else table.site + 1
        spoilt = {site for site, _ in placed.spoilt}
        closed = np.isin(np.arange(len(number)), placed.site)
        kinds = [
            (np.flatnonzero(closed), drawing.MEASURED),
            (np.array(sorted(spoilt), dtype=np.intp), drawing.FLAGGED),
        ]
        opened = np.flatnonzero(~closed & ~placed.outside & ~np.isin(np.arange(len(number)), list(spoilt)))
        drawing.crosses(ax, placed.position[opened], "open")
        for sites, colour in kinds:
            drawing.numbers(ax, placed.position[sites], [str(number[s]) for s in sites], colour)
        below = placed.position[opened] - [0.0, 0.02 * pixel * image.shape[0]]
        drawing.numbers(ax, below, [str(number[s]) for s in opened], drawing.OPEN)
    what = "site" if tracked.table.matched else "contact"
    drawing.heading(ax, f"{tracked.table.image[index]}: numbers are those of the column {what}")
    return figure
