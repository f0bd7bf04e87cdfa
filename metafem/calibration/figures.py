"""Figures of calibrations, of the contacts found in an image, and of made surfaces."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.drawing import calibration as lines
from metafem.drawing import contacts as drawing
from metafem.drawing import new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from metafem.calibration.compression import ContactCalibration
    from metafem.calibration.full_contact import StrengthFit
    from metafem.calibration.images import ContactAreas
    from metafem.calibration.sheared import ShearCalibration
    from metafem.calibration.sites import Placed
    from metafem.calibration.topography import MadeSurface
    from metafem.prediction import FrictionLaw


def calibration_figure(
    contact: ContactCalibration | None, shear: ShearCalibration | None, strength: StrengthFit | None = None
) -> Figure:
    """Return a figure of the calibrations that are not None, with their residuals."""
    fits: list[tuple[Callable[[Axes], Any], FloatArray, FloatArray, str]] = []
    if contact is not None:
        title = f"E* = {contact.composite_modulus:.4g} MPa"
        fits.append((contact.plot, contact.load, contact.residual, title))
    if shear is not None:
        area, friction = (partial(shear.plot, line=line) for line in ("area", "friction"))
        title = f"σ = {shear.shear_strength:.4g} MPa"
        fits.append((area, shear.area_before, shear.area_residual, f"B = {shear.area_ratio:.4g}"))
        fits.append((friction, shear.area_sheared, shear.friction_residual, title))
    if strength is not None:
        title = f"full contact: σ = {strength.shear_strength:.4g} MPa"
        fits.append((strength.plot, strength.area, strength.residual, title))
    figure, axes = lines.with_residuals(len(fits))
    for (law, below), (plot, x, residual, title) in zip(axes, fits, strict=True):
        plot(law)
        lines.residuals(below, x, residual)
        law.set_title(title)
        below.set_xlabel(law.get_xlabel())
        law.set_xlabel("")
    return figure


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


def made_figure(
    made: MadeSurface,
    designed: FrictionLaw,
    law: FrictionLaw,
) -> Figure:
    """Return a figure of the height errors at the sites and over height, the residuals and the two laws."""
    figure = new_figure(10.0, 8.4)
    (sites, residual), (heights, laws) = figure.subplots(2, 2)
    design = made.design
    lines.height_errors(sites, design.position[made.site], made.height_error, design.position[made.missing])
    lines.residual_map(residual, made.residual, *made.extent)
    lines.errors_over_height(heights, design.height[made.site], made.height_error, made.height_sd)
    lines.made_law(laws, designed.rescaled_load, designed.area, law.area)
    return figure
