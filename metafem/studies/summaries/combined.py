"""How likely a made surface meets its target, and how small its errors must be: the summary of combined."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from metafem._values import MICROMETRES, percent
from metafem.notes import information
from metafem.studies.summaries.table import Summary, stored_notes

if TYPE_CHECKING:
    from xarray import Dataset

# The tolerances in words, with their unit and its number in mm or rad.
TOLERANCES = {
    "all": ("all together", " ×", 1.0),
    "height_sd": ("heights", " µm (SD)", MICROMETRES),
    "angle": ("tilt about either axis", "°", math.degrees(1.0)),
    "radius_sd": ("radii", " µm (SD)", MICROMETRES),
    "position_sd": ("positions", " µm (SD)", MICROMETRES),
}


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
        largest = f"{factor * given:.3g}{unit}" if math.isfinite(factor) else in_words(factor)
        uncertain = f"{float(one['factor_error']) * given:.1g}{unit}" if math.isfinite(factor) else ""
        rows.append((words, f"{given:.3g}{unit}", largest, uncertain))
    low, middle, high = (percent(float(value)) for value in study["misfit_quantile"].values)
    exact = percent(round(float(study["nominal_misfit"]), 6))  # 0 for a misfit of rounding
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


def in_words(factor: float) -> str:
    """Return why there is no largest error."""
    return "none is small enough" if math.isnan(factor) else "no limit found"
