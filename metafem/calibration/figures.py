"""Figure of the contacts found in an image."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from metafem.drawing import contacts as drawing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from metafem.calibration.images import ContactAreas
    from metafem.calibration.sites import Placed


def found_figure(
    image: NDArray[Any], areas: ContactAreas, placed: Placed, number: Sequence[int], title: str
) -> Figure:
    """Return a figure of an image with its contacts, the numbers of their sites, and the open sites."""
    figure = drawing.picture_figure(*image.shape[::-1])
    ax = figure.add_subplot()
    drawing.picture(ax, image, areas.pixel_size)
    matched, flagged = placed.site >= 0, ~areas.complete
    for which, colour, label in (
        (matched & ~areas.saturated, drawing.MEASURED, "measured"),
        (flagged | (matched & areas.saturated), drawing.FLAGGED, "at the edge, merged or saturated"),
        (~matched & ~flagged, drawing.STRAY, "of no site"),
    ):
        drawing.outlines(ax, areas.centre[which], areas.axes[which], areas.angle[which], colour, label)
    away = placed.position.copy()
    # put the number next to the contact, outside its outline
    away[placed.site[matched]] = areas.centre[matched] + 0.75 * areas.axes[matched, :1] * [1.0, -1.0]
    closed = np.isin(np.arange(len(number)), placed.site)
    opened = ~closed & ~placed.unmeasured
    drawing.crosses(ax, placed.position[opened], "open")
    for which, colour in (
        (closed, drawing.MEASURED),
        (placed.unmeasured, drawing.FLAGGED),
        (opened, drawing.OPEN),
    ):
        drawing.numbers(ax, away[which], [str(n) for n in np.array(number)[which]], colour)
    drawing.heading(ax, title)
    return figure
