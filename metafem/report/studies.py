"""The studies of a design in the report: questions, answers and figures, and its measured laws."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import cycle
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._values import MICROMETRES
from metafem.drawing import ACHIEVED, MEASURED, QUIET, TARGET, finished, new_figure
from metafem.drawing.calibration import measured, residuals
from metafem.drawing.inline import drawn
from metafem.inversion import Design
from metafem.report.figures import BESIDE_TEXT, beside_text
from metafem.studies.summary import in_words, main_quantity, shares, summary

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from xarray import Dataset

# Margins with room for a legend above the axes, where it covers no bars [inch].
ABOVE = (0.9, 0.2, 0.6, 0.4)
LEGEND_ABOVE: dict[str, Any] = {
    "loc": "lower center", "bbox_to_anchor": (0.5, 1.0), "ncols": 2, "frameon": False,
}  # fmt: skip

# With fewer inputs than this, the bars are as wide as with this number of inputs.
FEW_BARS = 3

# Studies by the label that they have in the figure, such as the name of the surface; "" for no label.
Labelled = Mapping[str, "Dataset"]

# Largest number of assignments of heights to sites that are drawn; in the source paper's Fig. S2, about as
# many can be distinguished.
MOST_ASSIGNMENTS = 20

COLOURS = (ACHIEVED, TARGET)

# The axes of the measured law end at this multiple of the largest value that is shown.
ROOM = 1.08


@beside_text
def manufacturing_figure(ax: Axes, studies: Labelled) -> None:
    """Draw mean slope over nominal slope against the SD of the heights, with bars of ± SD, as in Fig. S3."""
    ax.axhline(1.0, color=QUIET, lw=0.8)
    for (label, study), colour in zip(studies.items(), cycle(COLOURS), strict=False):
        nominal, study = float(study["nominal_slope"]), study.sortby("height_sd")
        ax.errorbar(
            MICROMETRES * study["height_sd"].values,
            study["slope_mean"].values / nominal,
            study["slope_sd"].values / nominal,
            fmt="o-", ms=3, lw=1.2, capsize=2, color=colour, label=label or None,
        )  # fmt: skip
    ax.set(xlabel="standard deviation of the heights  SD(dh) [µm]", ylabel="slope over nominal, ± SD")


@beside_text
def misalignment_figure(ax: Axes, studies: Labelled) -> None:
    """Draw the SD of the slope over the nominal slope against the largest angle, as in Fig. S2."""
    for (label, study), colour in zip(studies.items(), cycle(COLOURS), strict=False):
        angle = np.append(0.0, np.degrees(study["angle"].values))
        scatter = 100.0 * study["slope_sd"].values / float(study["nominal_slope"])
        made, *assigned = np.pad(scatter, ((0, 0), (1, 0)))
        ax.plot(angle, made, color=colour, lw=1.8, label=f"{label} as made".strip())
        for i, each in enumerate(assigned[:MOST_ASSIGNMENTS]):
            name = f"{label} random assignments".strip() if i == 0 else None
            ax.plot(angle, each, "--", color=colour, lw=0.6, alpha=0.6, label=name)
    ax.set(xlabel="largest angle  |φ| [°]", ylabel="SD of the slope [%]", xlim=(0.0, None), ylim=(0.0, None))


def uncertainty_figure(study: Dataset) -> Figure:
    """Draw the share of each input in the variance."""
    figure = new_figure(*BESIDE_TEXT, (1.8, 0.2, 0.6, 0.4))
    ax, name = figure.add_subplot(), main_quantity(study)
    labels = [in_words(str(label)).removeprefix("the ") for label in study["parameter"].values]
    labels = [
        label.replace(" together with ", "\nwith ") for label in labels
    ]  # correlated parameters are one bar
    ax.barh(labels, 100.0 * shares(study, name, "total"), color=QUIET, label="with others")
    ax.barh(labels, 100.0 * shares(study, name, "first_order"), height=0.5, color=ACHIEVED, label="alone")
    ax.set_ylim(max(len(labels), FEW_BARS) - 0.5, -0.5)
    ax.legend(**LEGEND_ABOVE)
    ax.set(xlabel="share of the variance [%]", xlim=(0.0, None))
    return finished(figure)


# Of each study: its question, the command that answers it, the figure and its caption.
QUESTIONS: Mapping[str, tuple[str, str, Callable[[Dataset], Figure], str]] = {
    "manufacturing": (
        "How accurate must the heights be?",
        "metafem study manufacturing DIR",
        lambda study: manufacturing_figure({"": study}),
        "Mean slope over the nominal one, with bars of one standard deviation, against errors of heights.",
    ),
    "misalignment": (
        "How level must the glass be?",
        "metafem study misalignment DIR",
        lambda study: misalignment_figure({"": study}),
        "Standard deviation of the slope over the nominal slope against the largest angle of the glass.",
    ),
    "uncertainty": (
        "Which input matters most?",
        "metafem study uncertainty DIR --composite-modulus-sd 0.04MPa --radius-sd 2um",
        uncertainty_figure,
        "Share of each input in the variance.",
    ),
}


def study_sections(design: Design, studies: Mapping[str, Dataset]) -> dict[str, Any]:
    """Return the parts of the page on the accuracy of the part, the measured laws and what explains them."""
    sections: dict[str, Any] = {"answers": [], "missing": []}
    for name, (question, command, draw, caption) in QUESTIONS.items():
        if name in studies:
            picture = drawn(draw(studies[name]), question, caption)
            sections["answers"].append((name, picture, summary(studies[name])))
        else:
            sections["missing"].append((question, command))
    if "measured" in studies:
        sections["measured"] = measured_section(design, studies["measured"])
    if "explained" in studies:
        sections["explanation"] = summary(studies["explained"])
    return sections


def measured_section(design: Design, study: Dataset) -> dict[str, Any]:
    """Return the figure, the tables and the sentence of the measured laws."""
    names = {"composite_modulus": "E*", "shear_strength": "σ", "area_ratio": "B"}
    return {
        "summary": summary(study),
        "differs": not int(study["fits"]),
        "figure": drawn(measured_figure(design, study), "Measured and designed friction law"),
        # the parameters whose errors the standard deviations include
        "included": " and ".join(names[name] for name in str(study.attrs["parameters"]).split()),
    }


def measured_figure(design: Design, study: Dataset) -> Figure:
    """Draw the design's law with the measured points, and below it the deviations over their SD."""
    figure = new_figure(6.2, 4.9, ABOVE)
    ax, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1], gridspec_kw={"hspace": 0.08})
    design.law.plot(ax, label="design")
    x, x_sd = study["rescaled_load"].values, study["rescaled_load_sd"].values
    y, y_sd = study["rescaled_friction"].values, study["rescaled_friction_sd"].values
    measured(ax, x, y, x_sd, y_sd, "measured", MEASURED)
    residuals(below, x, (study["deviation"] / study["deviation_sd"]).values, MEASURED)
    for branch, _ in design.fits:
        for each in (ax, below):
            each.axvspan(*branch.load_range, color=QUIET, alpha=0.08, lw=0)
    below.set(xlabel=ax.get_xlabel(), ylabel="deviation\n[s.d.]")
    ax.set_xlabel("")
    end = ROOM * float((study["rescaled_load"] + study["rescaled_load_sd"]).max())
    ax.set_xlim(0.0, end)
    shown = np.interp(end, design.law.rescaled_load, design.law.rescaled_friction)
    ax.set_ylim(0.0, ROOM * max(float(study["rescaled_friction"].max()), float(shown)))
    # above the axes, because measured points may lie in any corner
    ax.legend(**LEGEND_ABOVE | {"ncols": 3})
    return finished(figure)
