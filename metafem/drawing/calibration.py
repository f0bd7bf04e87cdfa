"""Drawing of measured points and fitted laws, and of the errors of made surfaces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem import drawing
from metafem._values import MICROMETRES
from metafem.drawing import ACHIEVED, LARGEST_DOT, QUIET, TARGET, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Colour map of errors with both signs, and the percentage of residuals within the range of the colours.
SIGNS, SHOWN = "coolwarm", 99.0


def measured(
    ax: Axes,
    x: FloatArray,
    y: FloatArray,
    x_sd: FloatArray,
    y_sd: FloatArray,
    label: str | None = None,
    colour: str = ACHIEVED,
) -> None:
    """Draw measured points with error bars of one standard deviation."""
    ax.errorbar(x, y, y_sd, x_sd, fmt="o", ms=3.0, lw=0.9, color=colour, label=label, zorder=3.0)


def fitted(ax: Axes, x: FloatArray, y: FloatArray, label: str | None = None) -> None:
    """Draw a fitted law."""
    ax.plot(x, y, color=TARGET, lw=1.2, label=label, zorder=2.0)


def residuals(ax: Axes, x: FloatArray, residual: FloatArray, colour: str = ACHIEVED) -> None:
    """Draw residuals in units of their standard deviations, with a band from -1 to 1."""
    ax.axhspan(-1.0, 1.0, color=QUIET, alpha=0.2, lw=0.0)
    ax.axhline(0.0, color=TARGET, lw=1.2)
    ax.plot(x, residual, "o", ms=3.5, color=colour)
    ax.set_ylabel("residual / sd")


def height_errors(ax: Axes, position: FloatArray, error: FloatArray, missing: FloatArray) -> None:
    """Draw height errors (n,) [mm] at their sites (n, 2) as circles, and missing sites (m, 2) as rings."""
    diameter = LARGEST_DOT * drawing.spacing(position)
    dots = drawing.circles(ax, position, np.full(len(position), diameter), error * MICROMETRES)
    largest = float(np.abs(error).max() * MICROMETRES) or 1.0
    dots.set_cmap(SIGNS)
    dots.set_clim(-largest, largest)
    ax.figure.colorbar(dots, ax=ax, label="height error [µm]", shrink=0.85)
    drawing.rings(ax, missing, diameter)
    drawing.plan(ax)
    ax.set_title("made minus designed")


def errors_over_height(ax: Axes, height: FloatArray, error: FloatArray, sd: FloatArray) -> None:
    """Draw height errors (n,) against designed heights [mm]."""
    ax.axhline(0.0, color=QUIET, lw=0.8)
    height, error, sd = (MICROMETRES * values for values in (height, error, sd))
    ax.errorbar(height, error, sd, fmt="o", ms=3.5, lw=0.8, color=ACHIEVED)
    ax.set(xlabel="designed height [µm]", ylabel="height error [µm]")


def residual_map(ax: Axes, values: FloatArray, width: float, height: float) -> None:
    """Draw the residuals of a map with a width and a height [mm]; the largest 1 % have the end colours."""
    shown = np.ma.masked_invalid(values * MICROMETRES)
    known = np.abs(shown.compressed())
    largest = float(np.percentile(known, SHOWN)) if known.size else 1.0
    image = ax.imshow(
        shown, extent=(0.0, width, 0.0, height), cmap=SIGNS, vmin=-largest, vmax=largest or 1.0,
        interpolation="nearest", rasterized=True,
    )  # fmt: skip
    ax.figure.colorbar(image, ax=ax, label="residual [µm]", shrink=0.85, extend="both")
    ax.set(title="map minus base plane and spheres", xlabel="x on the map [mm]", ylabel="y on the map [mm]")


def made_law(ax: Axes, load: FloatArray, designed: FloatArray, made: FloatArray) -> None:
    """Draw the rescaled laws (k,) [mm^2] of the design and of the made surface."""
    drawing.law(ax, load, designed, forces=False, color=TARGET, label="designed")
    drawing.law(ax, load, made, forces=False, ls="--", label="made")
    ax.legend(frameon=False)
