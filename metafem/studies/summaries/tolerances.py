"""How exact the heights must be, and how level the plane: summaries of manufacturing and misalignment."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
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

# Largest number of rows of a table; of more levels or angles some are left out.
MOST_ROWS = 12


def manufacturing_summary(study: Dataset) -> Summary:
    """Return the slopes of surfaces whose heights have errors."""
    study = study.sortby("height_sd")
    deviation, nominal = study["height_sd"].values, float(study["nominal_slope"])
    mean, scatter = study["slope_mean"].values / nominal, study["slope_sd"].values / nominal
    error = study["slope_sd_error"].values / nominal
    columns: tuple[str, ...] = (
        *("SD of the heights [µm]", "mean slope", "change [%]", "SD of the slope [%]", "its error [%]"),
        *("5 % below [%]", "95 % below [%]", "plain draws of equal error"),
    )
    low, *_, high = study["slope_quantile"].transpose("quantile", ...).values / nominal - 1.0
    equal = study["draws"].values * study["saving"].sel(moment="sd").values
    rows = tuple(
        (
            f"{MICROMETRES * deviation[i]:.3g}",
            f"{nominal * mean[i]:.4f}",
            f"{100.0 * (mean[i] - 1.0):+.3f}",
            f"{100.0 * scatter[i]:.3f}",
            f"{100.0 * error[i]:.3f}",
            f"{100.0 * low[i]:+.2f}",
            f"{100.0 * high[i]:+.2f}",
            f"{equal[i]:.2g}",
        )
        for i in shown(len(deviation))
    )
    title = f"Slope of the law of made surfaces; {nominal:.4f} with exact heights"
    answer = answered(
        "errors of the heights of up to",
        deviation,
        scatter,
        lambda value: f"{MICROMETRES * value:.2g} µm (SD)",
    )
    furthest = float((mean - 1.0)[np.abs(mean - 1.0).argmax()])
    answer += f", and the largest change of its mean is {percent(furthest, '+.2g')}"
    return Summary(title, columns, rows, stored_notes(study), f"{answer}.")


def misalignment_summary(study: Dataset) -> Summary:
    """Return the scatter of the slope under tilts of the plane."""
    angle, nominal = study["angle"].values, float(study["nominal_slope"])
    scatter = study["slope_sd"].values / nominal
    columns: tuple[str, ...] = ("largest angle [°]", "mean slope", "SD of the slope [%]")
    rows: list[tuple[str, ...]] = [
        (
            f"{math.degrees(angle[i]):.3g}",
            f"{float(study['slope_mean'][0, i]):.4f}",
            f"{100.0 * scatter[0, i]:.3f}",
        )
        for i in shown(len(angle))
    ]
    shuffled = len(scatter) - 1
    if "slope_sd_quantile" in study:
        quantile = 100.0 * study["slope_sd_quantile"].values / nominal
        columns += tuple(f"{100.0 * q:.0f} % of the shuffled [%]" for q in study["quantile"].values)
        rows = [
            (*row, *(f"{value:.3f}" for value in quantile[:, i]))
            for row, i in zip(rows, shown(len(angle)), strict=True)
        ]
    answer = answered("tilts within", angle, scatter[0], lambda value: f"±{math.degrees(value):.2g}°")
    if shuffled:
        middle = percent(float(np.median(scatter[1:, -1])))
        answer += f", and by {middle} in the median of {shuffled} random assignments of the heights to sites"
    title = f"Slope of the law under tilts; {nominal:.4f} without a tilt"
    return Summary(title, columns, tuple(rows), stored_notes(study), f"{answer}.")


def answered(errors: str, value: FloatArray, scatter: FloatArray, written: Callable[[float], str]) -> str:
    """Return up to which errors the slope scatters by less than `ALLOWED`, and its scatter at the largest."""
    largest = reach(value, scatter)
    if math.isinf(largest):
        last = written(value[-1])
        return (
            f"With {errors} {last}, the largest studied, the slope scatters by less than {percent(ALLOWED)} "
            f"(SD), at most by {percent(scatter.max())}"
        )
    return (
        f"With {errors} {written(largest)} the slope scatters by less than {percent(ALLOWED)} (SD); with "
        f"{written(value[-1])} it scatters by {percent(scatter[-1])}"
    )


def shown(count: int) -> list[int]:
    """Return the rows to print: the last one, and before it every n-th, with n = 1, 2, 5, 10, 20, ..."""
    steps = (digit * 10**power for power in itertools.count() for digit in (1, 2, 5))
    step = next(step for step in steps if count <= MOST_ROWS * step)
    return list(range(count))[::-step][::-1]


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
