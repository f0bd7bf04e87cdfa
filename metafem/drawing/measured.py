"""Drawing of measured laws: points with error bars."""

from __future__ import annotations

from typing import TYPE_CHECKING

from metafem.drawing import MEASURED, MEASURED_BESIDE, QUIET, FloatArray, name_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Colours of several measured laws, such as static and sliding friction.
COLOURS = (MEASURED, MEASURED_BESIDE)


def points(
    ax: Axes,
    load: FloatArray,
    friction: FloatArray,
    load_sd: FloatArray,
    friction_sd: FloatArray,
    *,
    forces: bool,
    label: str | None = None,
    colour: str = MEASURED,
) -> None:
    """Draw measured points with error bars: forces [N], or rescaled load and friction [mm^2]."""
    ax.errorbar(
        load, friction, xerr=load_sd, yerr=friction_sd, fmt="o", ms=3.5, lw=1.0, color=colour, label=label
    )
    name_law(ax, forces=forces)


def residuals(ax: Axes, load: FloatArray, deviation: FloatArray, colour: str = MEASURED) -> None:
    """Draw deviations over their standard deviations, with lines at zero and at one of these."""
    ax.axhline(0.0, color=QUIET, lw=0.8)
    for level in (-1.0, 1.0):
        ax.axhline(level, color=QUIET, lw=0.6, ls=":")
    ax.plot(load, deviation, "o", ms=3.5, color=colour)
    ax.set_ylabel("deviation\n[s.d.]")
