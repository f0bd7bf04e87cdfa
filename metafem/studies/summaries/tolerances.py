"""Summaries of the studies manufacturing and misalignment: the required accuracy of the part."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem._values import MICROMETRES, percent
from metafem.studies.sampling.slope import ALLOWED
from metafem.studies.summaries.table import Summary, summarised, texts

if TYPE_CHECKING:
    from xarray import Dataset

# Largest number of rows of a table; if there are more levels or angles, some are left out.
MOST_ROWS = 12


# The tolerances in words, the units in which they are shown, and the factors from mm or rad to these units.
TOLERANCES = {
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
    study, nominal = study.sortby("height_sd"), float(study["nominal_slope"])
    answer = _answer(study, study["height_sd"].values, study["slope_sd"].values / nominal)
    study = study.isel(height_sd=shown(study.sizes["height_sd"]))
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
    }
    if "misfit_quantile" in study:
        misfit = study["misfit_quantile"].sel(quantile=0.95).values
        columns["misfit, 95 % below [%]"] = texts(".2f", 100.0 * misfit)
    title = f"Slope of the law of made surfaces; {nominal:.4f} with exact heights"
    return summarised(study, title, columns, answer)


def misalignment_summary(study: Dataset) -> Summary:
    """Return the table of the scatter of the slope under tilts of the plane, and a sentence."""
    nominal, every = float(study["nominal_slope"]), study.isel(placement=0)
    study = study.isel(angle=shown(study.sizes["angle"]))
    made = study.isel(placement=0)
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
    # without a tilt there is no scatter
    angle, values = (np.append(0.0, every[name].values) for name in ("angle", "slope_sd"))
    return summarised(study, title, columns, _answer(made, angle, values / nominal, median))


def _answer(study: Dataset, errors: FloatArray, scatter: FloatArray, more: str = "") -> str:
    """Return sentences on the errors that cause the allowed scatter, and on the effect of the largest.

    errors, scatter: (k,), increasing errors of the study and the relative scatter of the slope. The error
    that causes the allowed scatter is interpolated between them.
    """
    (name,) = map(str, study["slope_mean"].dims)
    kinds, at, number, kind = SENTENCES[name]

    def written(value: float) -> str:
        return number.format(TOLERANCES[name][2] * value) + kind

    last, allowed = study.isel({name: -1}), f"{percent(ALLOWED)} (SD)"
    mean, sd = (float(last[f"slope_{moment}"] / last["nominal_slope"]) for moment in ("mean", "sd"))
    there = (
        f"{at} {written(float(errors[-1]))} the slope scatters by {percent(sd)}{more}. "
        f"The mean slope changes there by {percent(round(mean - 1.0, 6), '+.2g')}."
    )
    beyond = np.flatnonzero(scatter > ALLOWED)
    if not beyond.size:
        return f"With {kinds} {written(float(errors[-1]))} the slope scatters by less than {allowed}. {there}"
    i = int(beyond[0])
    if i == 0:
        least = written(float(errors[0]))
        return f"Even with {kinds} {least} the slope scatters by more than {allowed}. {there}"
    limit = float(np.interp(ALLOWED, scatter[i - 1 : i + 1], errors[i - 1 : i + 1]))
    return f"With {kinds} {written(limit)} the slope scatters by less than {allowed}. {there}"


def shown(count: int) -> list[int]:
    """Return the rows to print: every n-th, counted back from the last row, with n = 1, 2, 5, 10, 20, ..."""
    steps = (digit * 10**power for power in itertools.count() for digit in (1, 2, 5))
    step = next(step for step in steps if count <= MOST_ROWS * step)
    return list(range(count))[::-step][::-1]
