"""Figures of studies; several surfaces can share one."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle
from typing import TYPE_CHECKING

from metafem._values import MICROMETRES
from metafem.drawing import ACHIEVED, QUIET, TARGET, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

# For labels on the left and below [inch].
MARGINS = (0.9, 0.2, 0.6, 0.2)

# Studies by their label in the figure, such as the name of the surface; one without a label is "".
Labelled = Mapping[str, "Dataset"]

COLOURS = (ACHIEVED, TARGET)


def manufacturing_figure(studies: Labelled) -> Figure:
    """Mean slope over the nominal one against the SD of the heights, with bars of ± SD, as Fig. S3."""
    figure = new_figure(7.0, 3.2, MARGINS)
    ax = figure.add_subplot()
    ax.axhline(1.0, color=QUIET, lw=0.8)
    for (label, study), colour in zip(studies.items(), cycle(COLOURS), strict=False):
        nominal = float(study["nominal_slope"])
        ax.errorbar(
            MICROMETRES * study["height_sd"].values,
            study["slope_mean"].values / nominal,
            study["slope_sd"].values / nominal,
            fmt="o-", ms=3, lw=1.2, capsize=2, color=colour, label=label or None,
        )  # fmt: skip
    ax.set_xlabel("standard deviation of the heights  SD(dh) [µm]")
    ax.set_ylabel("mean slope over nominal\nwith bars of ± SD")
    return _finished(figure, studies)


def _finished(figure: Figure, studies: Labelled) -> Figure:
    """Remove the frames; add a legend if the studies have labels."""
    for ax in figure.axes:
        ax.spines[["top", "right"]].set_visible(False)
    if any(studies):
        figure.axes[0].legend(frameon=False)
    return figure
