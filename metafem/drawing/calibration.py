"""Drawing of measured points and fitted laws."""

from __future__ import annotations

from typing import TYPE_CHECKING

from metafem.drawing import ACHIEVED, QUIET, TARGET, FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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


def residuals(ax: Axes, x: FloatArray, residual: FloatArray, colour: str = ACHIEVED) -> None:
    """Draw residuals in units of their standard deviations, with a band from -1 to 1."""
    ax.axhspan(-1.0, 1.0, color=QUIET, alpha=0.2, lw=0.0)
    ax.axhline(0.0, color=TARGET, lw=1.2)
    ax.plot(x, residual, "o", ms=3.5, color=colour)
    ax.set_ylabel("residual / sd")
