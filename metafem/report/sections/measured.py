"""The report's section on the measured law: comparison of its points with the design."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem.drawing import MEASURED, MEASURED_BESIDE, QUIET, calibration, finished, new_figure
from metafem.drawing.inline import drawn
from metafem.inversion import Design
from metafem.report.names import model_words
from metafem.studies.measured import answers, features, measured_summary

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

NAME = "measured"

# The axes end at this multiple of the largest value that is shown.
ROOM = 1.08

# Heights of the figure, of the margin above it, and of a row of its legend [inch].
HEIGHT, MARGIN, ROW = 5.6, 0.2, 0.22


def measured_section(design: Design, studies: Mapping[str, Dataset]) -> dict[str, Any] | None:
    """Return the figure, the tables and the sentences of the measured laws, or None if there are no laws."""
    if NAME not in studies:
        return None
    study = studies[NAME]
    more = features(study)
    return {
        **vars(measured_summary(study)),
        "answers": answers(study),
        "differs": not study["fits"].values.all(),
        "shaded": bool(design.fits),
        "bars": _bars(study),
        "figure": drawn(measured_figure(design, study), "Measured and designed friction law"),
        "feature_columns": more.columns,
        "features": more.rows,
    }


def measured_figure(design: Design, study: Dataset) -> Figure:
    """Draw the design's law with the measured points, and below it the deviations over their SD."""
    figure = new_figure(7.0, HEIGHT, (0.9, 0.2, 0.6, MARGIN))
    ax, below = figure.subplots(2, 1, sharex=True, height_ratios=[3, 1], gridspec_kw={"hspace": 0.08})
    design.law.plot(ax, label=f"design: {model_words(design.law.model)}")
    for label, colour in zip(map(str, study["law"].values), (MEASURED, MEASURED_BESIDE), strict=False):
        one = study.isel(point=np.flatnonzero(study["of_law"].values == label))
        x, x_sd = one["rescaled_load"].values, one["rescaled_load_sd"].values
        y, y_sd = one["rescaled_friction"].values, one["rescaled_friction_sd"].values
        calibration.measured(ax, x, y, x_sd, y_sd, f"measured: {label}", colour)
        calibration.residuals(below, x, (one["deviation"] / one["deviation_sd"]).values, colour)
    for branch, _ in design.fits:
        for each in (ax, below):
            each.axvspan(*branch.load_range, color=QUIET, alpha=0.08, lw=0)
    below.set(xlabel=ax.get_xlabel(), ylabel="deviation\n[s.d.]")
    ax.set_xlabel("")
    end = ROOM * float((study["rescaled_load"] + study["rescaled_load_sd"]).max())
    ax.set_xlim(0.0, end)
    shown = np.interp(end, design.law.rescaled_load, design.law.rescaled_friction)
    ax.set_ylim(0.0, ROOM * max(float(study["rescaled_friction"].max()), float(shown)))
    # the legend is above the axes, because measured points may lie in any corner
    handles, labels = ax.get_legend_handles_labels()
    rows = -(-len(labels) // 2)
    figure.subplots_adjust(top=1.0 - (MARGIN + ROW * rows) / HEIGHT)
    place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0)}
    ax.legend(handles, labels, frameon=False, ncols=2, fontsize="small", **place)
    return finished(figure)


def _bars(study: Dataset) -> str:
    """Return words on the parameters whose errors the standard deviations include; empty without any."""
    names = {"composite_modulus": "E*", "shear_strength": "σ", "area_ratio": "B"}
    found = [names[name] for name in str(study.attrs["parameters"]).split()]
    return f", which include the errors of {' and '.join(found)}" if found else ""
