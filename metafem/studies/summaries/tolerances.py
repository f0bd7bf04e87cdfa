"""Summaries of the studies manufacturing, misalignment and combined: the required accuracy of the part."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np

from metafem._values import MICROMETRES, percent, two_digits
from metafem.notes import information
from metafem.studies.summaries.table import Summary, stored_notes, summarised, texts

if TYPE_CHECKING:
    from xarray import Dataset

# Half-width of the interval that is stated for a largest error, in standard errors.
ERRORS = 2.0

# Largest number of rows of a table; if there are more levels or angles, some are left out.
MOST_ROWS = 12


# The tolerances in words, the units in which they are shown, and the factors from mm or rad to these units.
TOLERANCES = {
    "all": ("all together", " ×", 1.0),
    "height_sd": ("heights", " µm (SD)", MICROMETRES),
    "angle": ("tilt about either axis", "°", math.degrees(1.0)),
    "radius_sd": ("radii", " µm (SD)", MICROMETRES),
    "position_sd": ("positions", " µm (SD)", MICROMETRES),
}

# Words for a study of one tolerance: errors up to a value, errors at a value, the value, and its kind.
SENTENCES = {
    "height_sd": ("errors of the heights of up to", "At", "{:.3g} µm", " (SD)"),
    "angle": ("tilts within", "Within", "±{:.3g}°", ""),
}


def manufacturing_summary(study: Dataset) -> Summary:
    """Return the table of the slopes of surfaces whose heights have errors, and a sentence."""
    study = study.sortby("height_sd").isel(height_sd=shown(study.sizes["height_sd"]))
    nominal = float(study["nominal_slope"])
    mean, scatter, error = (study[f"slope_{name}"].values / nominal for name in ("mean", "sd", "sd_error"))
    low, *_, high = study["slope_quantile"].transpose("quantile", ...).values / nominal - 1.0
    columns = {
        "SD of the heights [µm]": texts(".3g", MICROMETRES * study["height_sd"].values),
        "mean slope": texts(".4f", nominal * mean),
        "change [%]": texts("+.3f", 100.0 * (mean - 1.0)),
        "SD of the slope [%]": texts(".3f", 100.0 * scatter),
        "its error [%]": texts(".3f", 100.0 * error),
        "5 % below [%]": texts("+.2f", 100.0 * low),
        "95 % below [%]": texts("+.2f", 100.0 * high),
        "plain draws of equal error": map(
            two_digits, study["draws"].values * study["saving"].sel(moment="sd").values
        ),
    }
    title = f"Slope of the law of made surfaces; {nominal:.4f} with exact heights"
    return summarised(study, title, columns, _answer(study))


def misalignment_summary(study: Dataset) -> Summary:
    """Return the table of the scatter of the slope under tilts of the plane, and a sentence."""
    study = study.isel(angle=shown(study.sizes["angle"]))
    nominal, made = float(study["nominal_slope"]), study.isel(placement=0)
    scatter = study["slope_sd"].values / nominal
    columns = {
        "largest angle [°]": texts(".3g", np.degrees(study["angle"].values)),
        "mean slope": texts(".4f", made["slope_mean"].values),
        "SD of the slope [%]": texts(".3f", 100.0 * scatter[0]),
    }
    if "slope_sd_quantile" in study:
        quantile = 100.0 * study["slope_sd_quantile"].values / nominal
        for share, values in zip(study["quantile"].values, quantile, strict=True):
            columns[f"{100.0 * share:.0f} % of the shuffled [%]"] = texts(".3f", values)
    median = ""
    if shuffled := len(scatter) - 1:
        middle = percent(float(np.median(scatter[1:, -1])))
        median = f", and by {middle} in the median of {shuffled} random assignments of the heights to sites"
    title = f"Slope of the law under tilts; {nominal:.4f} without a tilt"
    return summarised(study, title, columns, _answer(made, median))


def combined_summary(study: Dataset) -> Summary:
    """Return the table of the largest errors for the required probability, and a sentence."""
    met, error = float(study["probability"]), float(study["probability_error"])
    wanted = percent(float(study.attrs["wanted_probability"]), ".4g")
    within = percent(float(study.attrs["misfit"]), ".3g")
    names = study["tolerance"].values.tolist()
    rows = []
    found = (study[name].values.tolist() for name in ("factor", "factor_error", "given"))
    for name, factor, sd, given in zip(names, *found, strict=True):
        words, unit, size = TOLERANCES[name]
        largest = ("none is small enough" if math.isnan(factor) else "no limit found", "")
        if math.isfinite(factor):
            largest = f"{factor * (size * given):.3g}{unit}", f"{sd * (size * given):.1g}{unit}"
        rows.append((words, f"{size * given:.3g}{unit}", *largest))
    low, middle, high = (percent(float(value)) for value in study["misfit_quantile"].values)
    exact = percent(round(float(study["nominal_misfit"]), 6))  # a misfit due to rounding becomes 0
    spread = information(
        f"misfit {exact} without errors; median of the surfaces {middle}, 90 % of them from {low} to {high}"
    )
    title = f"Target met within {within}: probability {100.0 * met:.1f} ± {100.0 * error:.1f} %"
    answer = (
        f"A surface made with the stated errors meets the target within {within} with a probability of "
        f"{percent(met, '.3g')}"
    )
    if "all" in names:
        factor, sd = (float(study[name].sel({"tolerance": "all"})) for name in ("factor", "factor_error"))
        limit = "no errors are small enough" if math.isnan(factor) else "they may be much larger"
        if math.isfinite(factor):
            limit = f"all errors may be at most {factor:.3g} ± {sd:.1g} times as large"
        answer += f"; for {wanted} {limit}"
    columns = ("error", "given", f"largest for {wanted}", "its error")
    return Summary(title, columns, tuple(rows), (spread, *stored_notes(study)), f"{answer}.")


def _answer(study: Dataset, more: str = "") -> str:
    """Return sentences on the errors that cause the allowed scatter, and on the effect of the largest."""
    (name,) = map(str, study["slope_mean"].dims)
    errors, at, number, kind = SENTENCES[name]

    def written(value: float) -> str:
        return number.format(TOLERANCES[name][2] * value)

    last = study.isel({name: -1})
    mean, sd = (float(last[f"slope_{moment}"] / last["nominal_slope"]) for moment in ("mean", "sd"))
    change = percent(round(mean - 1.0, 6), "+.2g")
    there = (
        f"{at} {written(float(last[name]))}{kind} the slope scatters by {percent(sd)}{more}. "
        f"The mean slope changes there by {change}."
    )
    value, error = float(study[f"largest_{name}"]), ERRORS * float(study[f"largest_{name}_error"])
    allowed = f"{percent(study.attrs['allowed_scatter'])} (SD)"
    if math.isinf(value):
        return f"No errors were found with which the slope scatters by {allowed}. {there}"
    if math.isnan(value):
        return f"No errors are small enough for a slope that scatters by less than {allowed}. {there}"
    if not error < value:
        return f"The draws are too few to state with which errors the slope scatters by {allowed}. {there}"
    low, high = written(value - error), written(value + error)
    if low != high:
        allowed += f"; this limit lies between {low} and {high} (± two standard errors)"
    return f"With {errors} {written(value)}{kind} the slope scatters by less than {allowed}. {there}"


def shown(count: int) -> list[int]:
    """Return the rows to print: every n-th, counted back from the last row, with n = 1, 2, 5, 10, 20, ..."""
    steps = (digit * 10**power for power in itertools.count() for digit in (1, 2, 5))
    step = next(step for step in steps if count <= MOST_ROWS * step)
    return list(range(count))[::-step][::-1]
