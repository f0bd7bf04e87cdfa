"""Figures of studies; one figure can show several surfaces."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._values import MICROMETRES
from metafem.drawing import ACHIEVED, QUIET, TARGET, finished, law, new_figure
from metafem.studies.summary import in_words, main_quantity, shares

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

# Margins on the left, on the right, below and above [inch]. On the left and below there are labels, and
# numbers of at most seven characters.
MARGINS = (1.0, 0.2, 0.65, 0.2)

# Margins with room for a legend above the axes, where it covers no bars.
ABOVE = (1.0, 0.2, 0.65, 0.4)
LEGEND_ABOVE: dict[str, Any] = {
    "loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "ncols": 2, "frameon": False,
}  # fmt: skip

# With fewer inputs than this, the bars are as wide as with this number of inputs.
FEW_BARS = 3

# Studies by the label that they have in the figure, such as the name of the surface; "" for no label.
Labelled = Mapping[str, "Dataset"]

# Largest number of shuffled placements that are drawn; in the source paper's Fig. S2, about as many can be
# distinguished.
MOST_SHUFFLES = 20

# Approximate number of error bars on a law.
BARS = 12

COLOURS = (ACHIEVED, TARGET)


def manufacturing_figure(studies: Labelled) -> Figure:
    """Draw mean slope over nominal slope against the SD of the heights, with bars of ± SD, as in Fig. S3."""
    figure = new_figure(7.0, 3.2, MARGINS)
    ax = figure.add_subplot()
    ax.axhline(1.0, color=QUIET, lw=0.8)
    for (label, study), colour in zip(studies.items(), cycle(COLOURS), strict=False):
        nominal, study = float(study["nominal_slope"]), study.sortby("height_sd")
        ax.errorbar(
            MICROMETRES * study["height_sd"].values,
            study["slope_mean"].values / nominal,
            study["slope_sd"].values / nominal,
            fmt="o-", ms=3, lw=1.2, capsize=2, color=colour, label=label or None,
        )  # fmt: skip
    ax.set(xlabel="standard deviation of the heights  SD(dh) [µm]", ylabel="mean slope over nominal, ± SD")
    return finished(figure)


def misalignment_figure(studies: Labelled) -> Figure:
    """Draw the SD of the slope over the nominal slope against the largest angle, as in Fig. S2."""
    figure = new_figure(7.0, 3.2, MARGINS)
    ax = figure.add_subplot()
    for (label, study), colour in zip(studies.items(), cycle(COLOURS), strict=False):
        angle = np.append(0.0, np.degrees(study["angle"].values))
        scatter = 100.0 * study["slope_sd"].values / float(study["nominal_slope"])
        made, *shuffled = np.pad(scatter, ((0, 0), (1, 0)))
        ax.plot(angle, made, color=colour, lw=1.8, label=f"{label} as made".strip())
        for i, each in enumerate(shuffled[:MOST_SHUFFLES]):
            name = f"{label} shuffled".strip() if i == 0 else None
            ax.plot(angle, each, "--", color=colour, lw=0.6, alpha=0.6, label=name)
    ax.set(xlabel="largest angle  |φ| [°]", ylabel="SD of the slope over nominal [%]")
    ax.set_xlim(left=0.0)
    ax.set_ylim(bottom=0.0)
    return finished(figure)


def uncertainty_figure(study: Dataset) -> Figure:
    """Draw the law with its error bars, and the share of each input in the variance."""
    figure = new_figure(9.0, 3.3, ABOVE)
    left, right = figure.subplots(1, 2, gridspec_kw={"wspace": 0.55})
    name = main_quantity(study)
    drawn = "area" if name == "deviation" else name
    load, mean, sd = (study[each].values for each in ("rescaled_load", f"{drawn}_mean", f"{drawn}_sd"))
    law(left, load, mean, forces=False)
    if drawn == "friction_force":
        left.set_ylabel("friction force  F [N]")
    some = slice(None, None, -max(1, len(load) // BARS))
    left.errorbar(load[some], mean[some], sd[some], fmt="none", capsize=2, lw=1.2, color=ACHIEVED)
    if "deviation_sd" in study:
        moments = [f"rescaled_{name}_{moment}" for name in ("load", "friction") for moment in ("mean", "sd")]
        x, dx, y, dy = (study[each].values for each in moments)
        left.errorbar(x, y, dy, dx, fmt="o", ms=3, lw=1.2, color=TARGET, label="measured")
    total, first = shares(study, name, "total"), shares(study, name, "first_order")
    names = [in_words(str(label)).removeprefix("the ") for label in study["parameter"].values]
    labels = [name.replace(" and ", "\nand ") for name in names]  # correlated inputs are one bar
    right.barh(labels, 100.0 * total, color=QUIET, label="with others")
    right.barh(labels, 100.0 * first, height=0.5, color=ACHIEVED, label="alone")
    right.set_ylim(max(len(labels), FEW_BARS) - 0.5, -0.5)
    right.legend(**LEGEND_ABOVE)
    right.set_xlabel("share of the variance [%]")
    right.set_xlim(left=0.0)
    return finished(figure)
