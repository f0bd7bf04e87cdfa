"""How exact the heights must be, and how level the plane: summaries of manufacturing and misalignment."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem._values import MICROMETRES, percent
from metafem.inversion.assessment import REACHED
from metafem.studies.summaries.table import Summary, stored_notes

if TYPE_CHECKING:
    from xarray import Dataset

# The scatter of the slope that a part may have, as a fraction: a law within it counts as reached.
ALLOWED = REACHED

# Largest number of rows of a table; of more levels or angles every n-th is shown.
MOST_ROWS = 12


def manufacturing_summary(study: Dataset) -> Summary:
    """Return the slopes of surfaces whose heights have errors."""
    deviation, nominal = study["height_sd"].values, float(study["nominal_slope"])
    mean, scatter = study["slope_mean"].values / nominal, study["slope_sd"].values / nominal
    error = study["slope_sd_error"].values / nominal
    columns = ("SD of the heights [µm]", "mean slope", "change [%]", "SD of the slope [%]", "its error [%]")
    rows = tuple(
        (
            f"{MICROMETRES * deviation[i]:.3g}",
            f"{nominal * mean[i]:.4f}",
            f"{100.0 * (mean[i] - 1.0):+.3f}",
            f"{100.0 * scatter[i]:.3f}",
            f"{100.0 * error[i]:.3f}",
        )
        for i in shown(len(deviation))
    )
    title = f"Slope of the law of made surfaces; {nominal:.4f} with exact heights"
    largest, end = reach(deviation, scatter), percent(scatter[-1])
    last = f"{MICROMETRES * deviation[-1]:.3g} µm"
    if math.isinf(largest):
        answer = (
            f"Errors of the heights of {last} (SD), the largest studied, scatter the slope by {end} (SD)."
        )
    else:
        answer = (
            f"Errors of the heights of up to {MICROMETRES * largest:.2g} µm (SD) keep the scatter of the "
            f"slope (SD) below {percent(ALLOWED)}; at {last} it is {end}."
        )
    return Summary(title, columns, rows, stored_notes(study), answer)


def shown(count: int) -> list[int]:
    """Return the rows to print: all, or every n-th with the last one."""
    return list(range(count))[:: -max(1, math.ceil(count / MOST_ROWS))][::-1]


def reach(value: FloatArray, scatter: FloatArray) -> float:
    """Return up to which value the scatter stays within `ALLOWED`, inf if it does at all of them.

    The scatter is interpolated linearly, from 0 at the value 0.
    """
    beyond = np.flatnonzero(scatter > ALLOWED)
    if not beyond.size:
        return math.inf
    i = int(beyond[0])
    x0, y0 = (value[i - 1], scatter[i - 1]) if i else (0.0, 0.0)
    return float(x0 + (ALLOWED - y0) / (scatter[i] - y0) * (value[i] - x0))
