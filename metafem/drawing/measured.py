"""Drawing of measured laws: points with error bars."""

from __future__ import annotations

from typing import TYPE_CHECKING

from metafem.drawing import MEASURED, FloatArray, name_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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
