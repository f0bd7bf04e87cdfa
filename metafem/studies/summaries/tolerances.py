"""Required accuracy of the part: summaries of manufacturing, misalignment and combined."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from metafem._values import MICROMETRES, percent, two_digits
from metafem.notes import information
from metafem.studies.summaries.table import Summary, stored_notes

if TYPE_CHECKING:
    from xarray import Dataset

# The largest errors are stated with this number of standard errors on both sides.
ERRORS = 2.0

# Largest number of rows of a table; if there are more levels or angles, some are left out.
MOST_ROWS = 12


# The tolerances in words, with their unit and its number in mm or rad.
TOLERANCES = {
    "all": ("all together", " ×", 1.0),
    "height_sd": ("heights", " µm (SD)", MICROMETRES),
    "angle": ("tilt about either axis", "°", math.degrees(1.0)),
    "radius_sd": ("radii", " µm (SD)", MICROMETRES),
    "position_sd": ("positions", " µm (SD)", MICROMETRES),
}


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
            two_digits(equal[i]),
        )
        for i in shown(len(deviation))
    )
    title = f"Slope of the law of made surfaces; {nominal:.4f} with exact heights"
    answer = answered(
        study, "errors of the heights of up to", lambda value: f"{MICROMETRES * value:.3g} µm", " (SD)"
    )
    return Summary(title, columns, rows, stored_notes(study), answer)


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
    median = ""
    if shuffled:
        middle = percent(float(np.median(scatter[1:, -1])))
        median = f", and by {middle} in the median of {shuffled} random assignments of the heights to sites"
    made = study.isel(placement=0)
    answer = answered(made, "tilts within", lambda value: f"±{math.degrees(value):.3g}°", more=median)
    title = f"Slope of the law under tilts; {nominal:.4f} without a tilt"
    return Summary(title, columns, tuple(rows), stored_notes(study), answer)


def combined_summary(study: Dataset) -> Summary:
    """Return the probability of meeting the target, and the largest errors with the wanted probability."""
    met, error = float(study["probability"]), float(study["probability_error"])
    wanted = percent(float(study.attrs["wanted_probability"]), ".4g")
    within = percent(float(study.attrs["misfit"]), ".3g")
    columns = ("error", "given", f"largest for {wanted}", "its error")
    rows = []
    for name in map(str, study["tolerance"].values):
        one = study.sel({"tolerance": name})
        words, unit, size = TOLERANCES[name]
        factor, given = float(one["factor"]), size * float(one["given"])
        largest = f"{factor * given:.3g}{unit}" if math.isfinite(factor) else _without_limit(factor)
        uncertain = f"{float(one['factor_error']) * given:.1g}{unit}" if math.isfinite(factor) else ""
        rows.append((words, f"{given:.3g}{unit}", largest, uncertain))
    low, middle, high = (percent(float(value)) for value in study["misfit_quantile"].values)
    exact = percent(round(float(study["nominal_misfit"]), 6))  # 0 for a misfit from rounding
    spread = information(
        f"misfit {exact} without errors; median of the surfaces {middle}, 90 % of them from {low} to {high}"
    )
    title = f"Target met within {within}: probability {100.0 * met:.1f} ± {100.0 * error:.1f} %"
    answer = (
        f"A surface made with the stated errors meets the target within {within} with a probability of "
        f"{percent(met, '.3g')}"
    )
    if "all" in study["tolerance"].values:
        factor, sd = (float(study[name].sel({"tolerance": "all"})) for name in ("factor", "factor_error"))
        if math.isfinite(factor):
            answer += f"; for {wanted} all errors may be at most {factor:.3g} ± {sd:.1g} times as large"
        else:
            answer += f"; for {wanted} " + (
                "they may be much larger" if factor > 0.0 else "no errors are small enough"
            )
    return Summary(title, columns, tuple(rows), (spread, *stored_notes(study)), f"{answer}.")


def _without_limit(factor: float) -> str:
    """Return why there is no largest error."""
    return "none is small enough" if math.isnan(factor) else "no limit found"


def answered(
    study: Dataset, errors: str, written: Callable[[float], str], kind: str = "", more: str = ""
) -> str:
    """Return the errors at which the slope scatters as allowed, and the effect of the largest ones."""
    (name,) = map(str, study["slope_mean"].dims)
    last = study.isel({name: -1})
    mean, sd = (float(last[f"slope_{moment}"] / last["nominal_slope"]) for moment in ("mean", "sd"))
    where = "Within" if name == "angle" else "At"
    there, change = f"{where} {written(float(last[name]))}{kind}", percent(round(mean - 1.0, 6), "+.2g")
    return (
        f"{_limit(study, name, errors, written, kind)}{there} the slope scatters by {percent(sd)}{more}. "
        f"The mean slope changes there by {change}."
    )


def _limit(study: Dataset, name: str, errors: str, written: Callable[[float], str], kind: str) -> str:
    """Return the errors at which the slope scatters as allowed, as computed by the study."""
    if f"largest_{name}" not in study:  # a study of an earlier version
        return ""
    value, error = float(study[f"largest_{name}"]), ERRORS * float(study[f"largest_{name}_error"])
    allowed = f"{percent(study.attrs['allowed_scatter'])} (SD)"
    if math.isinf(value):
        return f"No errors were found with which the slope scatters by {allowed}. "
    if math.isnan(value):
        return f"No errors are small enough for a slope that scatters by less than {allowed}. "
    if not error < value:
        return f"The draws are too few to state with which errors the slope scatters by {allowed}. "
    low, high = written(value - error), written(value + error)
    if low != high:
        allowed += f"; this limit lies between {low} and {high} (± two standard errors)"
    return f"With {errors} {written(value)}{kind} the slope scatters by less than {allowed}. "


def shown(count: int) -> list[int]:
    """Return the rows to print: the last one, and before it every n-th, with n = 1, 2, 5, 10, 20, ..."""
    steps = (digit * 10**power for power in itertools.count() for digit in (1, 2, 5))
    step = next(step for step in steps if count <= MOST_ROWS * step)
    return list(range(count))[::-step][::-1]
