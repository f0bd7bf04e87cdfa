"""Figure of the contacts found in an image."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.drawing import contacts as drawing

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pandas import DataFrame

    from metafem.calibration.images import ContactAreas


def found_figure(
    image: NDArray[Any], areas: ContactAreas, rows: DataFrame, where: FloatArray, title: str
) -> Figure:
    """Return a figure of an image with its contacts, the numbers of their sites, and the open sites.

    `rows` are those of the image in the table of contacts, and `where` (m, 2) the places of its sites [mm].
    """
    figure = drawing.picture_figure(*image.shape[::-1])
    ax = figure.add_subplot()
    drawing.picture(ax, image, areas.pixel_size)
    area = rows["area"].to_numpy()
    matched, flagged = np.isin(areas.area, area), ~areas.complete
    for which, colour, label in (
        (matched, drawing.MEASURED, "measured"),
        (flagged, drawing.FLAGGED, "at the edge or merged"),
        (~matched & ~flagged, drawing.STRAY, "of no site"),
    ):
        drawing.outlines(ax, areas.centre[which], areas.axes[which], areas.angle[which], colour, label)
    drawing.crosses(ax, where[area == 0.0], "open")
    # put the number next to the contact, outside its outline
    away = where + 0.75 * np.sqrt(np.nan_to_num(area) / np.pi)[:, None] * [1.0, -1.0]
    numbers = rows["contact"] if rows["site"].isna().any() else rows["site"] + 1
    numbers = numbers.astype(str).to_numpy()
    for which, colour in (
        (area > 0.0, drawing.MEASURED),
        (np.isnan(area), drawing.FLAGGED),
        (area == 0.0, drawing.OPEN),
    ):
        drawing.numbers(ax, away[which], numbers[which], colour)
    drawing.heading(ax, title)
    return figure
