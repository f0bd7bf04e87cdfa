"""Figures of the contacts found in an image, and of made surfaces."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.calibration.topography import HeightMap, cells
from metafem.drawing import calibration as lines
from metafem.drawing import contacts as drawing
from metafem.drawing import new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from metafem.calibration.images import ContactAreas
    from metafem.calibration.sites import TrackedContacts
    from metafem.calibration.topography import MadeSurface
    from metafem.prediction import FrictionLaw

# Largest number of cells along an axis of the residual map. The means over cells are less noisy than pixels.
MOST = 300


def found_figure(
    image: NDArray[Any], areas: ContactAreas, tracked: TrackedContacts, index: int, sheared: bool = False
) -> Figure:
    """Return a figure of one image of a stack with its contacts, their site numbers and the open sites."""
    placed = (tracked.placed_sheared if sheared else tracked.placed)[index]
    pixel = areas.pixel_size
    figure = drawing.picture_figure(*image.shape[::-1])
    ax = figure.add_subplot()
    drawing.picture(ax, image, pixel)
    matched = np.zeros(areas.count, dtype=bool) if placed is None else placed.site >= 0
    flagged = ~areas.complete
    for which, colour, label in (
        (matched & ~areas.saturated, drawing.MEASURED, "measured"),
        (flagged | (matched & areas.saturated), drawing.FLAGGED, "at the edge, merged or saturated"),
        (~matched & ~flagged, drawing.STRAY, "of no site"),
    ):
        drawing.outlines(ax, areas.centre[which], areas.axes[which], areas.angle[which], colour, label)
    if placed is not None:
        table = tracked.table
        number = table.site if table.matched else table.site + 1
        sites, away = np.arange(len(number)), placed.position.copy()
        # put the number next to the contact, outside its outline
        half = 0.75 * areas.axes[matched, :1] * [1.0, -1.0]
        away[placed.site[matched]] = areas.centre[matched] + half
        closed, spoilt = np.isin(sites, placed.site), np.isin(sites, [site for site, _ in placed.spoilt])
        opened = ~closed & ~spoilt & ~placed.outside
        drawing.crosses(ax, placed.position[opened], "open")
        for which, colour in ((closed, drawing.MEASURED), (spoilt, drawing.FLAGGED), (opened, drawing.OPEN)):
            drawing.numbers(ax, away[which], [str(n) for n in number[which]], colour)
    what = "site" if tracked.table.matched else "contact"
    drawing.heading(ax, f"{tracked.table.image[index]}: numbers are those of the column {what}")
    return figure


def residuals(height_map: HeightMap, made: MadeSurface) -> FloatArray:
    """Return the mean residuals of a made surface in square cells of its height map [mm].

    The mean height of a sphere over a cell of side s is s^2 / (12 R) below the height at the centre of the
    cell. Therefore the base plane and the spheres are subtracted from each pixel, before the means are taken.
    """
    side = math.ceil(max(height_map.values.shape) / MOST)
    return cells(height_map, side, partial(_expected, height_map, made)).mean


def _expected(height_map: HeightMap, made: MadeSurface, rows: slice, columns: slice) -> FloatArray:
    """Return the heights of the base plane and the spheres at the pixels in these rows and columns [mm]."""
    x, y = height_map.x(columns), height_map.y(rows)
    result = made.levelling.base(x[None, :], y[:, None])
    for centre, height, radius in zip(
        made.on_map, made.surface.height.tolist(), made.surface.radius.tolist(), strict=True
    ):
        foot = math.sqrt(max(height * (2.0 * radius - height), 0.0))
        row, column = height_map.window(centre, foot + max(height_map.pixel))
        row = slice(max(row.start - rows.start, 0), max(row.stop - rows.start, 0))
        square = (x[column] - centre[0]) ** 2 + (y[row, None] - centre[1]) ** 2
        under = np.maximum(radius**2 - square, (radius - height) ** 2)
        result[row, column] += np.sqrt(under) - (radius - height)
    return result


def made_figure(
    made: MadeSurface,
    height_map: HeightMap,
    designed: FrictionLaw,
    law: FrictionLaw,
) -> Figure:
    """Return a figure of the height errors at the sites and over height, the residuals and the two laws."""
    figure = new_figure(10.0, 8.4)
    (sites, residual), (heights, laws) = figure.subplots(2, 2)
    design = made.design
    lines.height_errors(sites, design.position[made.site], made.height_error, design.position[made.missing])
    lines.residual_map(residual, residuals(height_map, made), *height_map.extent)
    lines.errors_over_height(heights, design.height[made.site], made.height_error, made.height_sd)
    lines.made_law(laws, designed.rescaled_load, designed.area, law.area)
    return figure
