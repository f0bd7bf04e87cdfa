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
        sites = np.arange(len(number))
        away = placed.position.copy()
        matched = placed.site >= 0
        # beside a contact, outside its outline
        half = 0.75 * areas.axes[matched, :1] * [1.0, -1.0]
        away[placed.site[matched]] = areas.centre[matched] + half
        closed, flagged = np.isin(sites, placed.site), np.isin(sites, list(spoilt))
        opened = ~closed & ~flagged & ~placed.outside
        drawing.crosses(ax, placed.position[opened], "open")
        for which, colour in (
            (closed, drawing.MEASURED),
            (flagged, drawing.FLAGGED),
            (opened, drawing.OPEN),
        ):
            drawing.numbers(ax, away[which], [str(n) for n in number[which]], colour)
    what = "site" if tracked.table.matched else "contact"
    drawing.heading(ax, f"{tracked.table.image[index]}: numbers are those of the column {what}")
    return figure
