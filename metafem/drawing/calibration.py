"""Drawing of measured points with error bars, of fitted laws and of residuals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem.drawing import ACHIEVED, QUIET, TARGET, FloatArray, new_figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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


def proportional(
    ax: Axes, x: FloatArray, y: FloatArray, x_sd: FloatArray, y_sd: FloatArray, factor: float
) -> None:
    """Draw measured points, and the fitted line through the origin with the slope `factor`."""
    measured(ax, x, y, x_sd, y_sd)
    ends = np.array([0.0, 1.05 * float(np.nanmax(x))])
    fitted(ax, ends, factor * ends)
    ax.set_xlim(left=0.0)
    ax.set_ylim(bottom=0.0)


def residuals(ax: Axes, x: FloatArray, residual: FloatArray, colour: str = ACHIEVED) -> None:
    """Draw residuals in units of their standard deviations, with a band from -1 to 1."""
    ax.axhspan(-1.0, 1.0, color=QUIET, alpha=0.2, lw=0.0)
    ax.axhline(0.0, color=TARGET, lw=1.2)
    ax.plot(x, residual, "o", ms=3.5, color=colour)
    ax.set_ylabel("residual / sd")


def with_residuals(columns: int = 1) -> tuple[Figure, list[tuple[Axes, Axes]]]:
    """Return a figure for fits side by side, and for each fit its axes and, below, those of its residuals."""
    figure = new_figure(4.6 * columns, 4.6)
    grid = figure.subplots(2, columns, squeeze=False, sharex="col", gridspec_kw={"height_ratios": [3.0, 1.0]})
    return figure, [(grid[0, i], grid[1, i]) for i in range(columns)]
