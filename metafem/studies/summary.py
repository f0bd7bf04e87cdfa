"""Summaries of studies: the table, and the answer in a sentence."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem._values import MICROMETRES, percent
from metafem.errors import refuse_if
from metafem.inversion.refinement import REACHED
from metafem.studies.dataset import Summary, texts
from metafem.studies.measured import explained_summary, measured_summary

if TYPE_CHECKING:
    from xarray import Dataset

# Largest number of rows of a table; if there are more levels or angles, some are left out.
MOST_ROWS = 10

# Loads with a column of their own, as fractions of the largest load.
SHOWN_LOADS = (0.1, 0.4, 1.0)

# Meaning of the last columns of the interaction table.
RANDOM = "asperities assigned to the sites at random, at every fifth load"

# Words for the inputs; each begins with an article.
WORDS = {
    "radius": "the radius R",
    "composite_modulus": "the composite modulus E*",
    "load": "the load P",
    "shear_strength": "the shear strength σ",
    "area_ratio": "the area ratio B",
}

# Quantities that a study may contain, the most informative first, in words.
QUANTITIES = {
    "friction_force": "the friction force",
    "area": "the real contact area",
}


def summary(study: Dataset) -> Summary:
    """Return the summary of a study: a table, notes and a sentence.

    Parameters
    ----------
    study : xarray.Dataset
        Result of a function of `metafem.studies`.

    Returns
    -------
    Summary

    Raises
    ------
    InvalidInput
        If the dataset is not the result of a study.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(mf.OperatingPoints([0.01], [0.1]), template)
    >>> summary(mf.studies.interaction(design, assignments=5)).columns[:3]
    ('model', 'rms [%]', 'largest [%]')
    """
    name = str(study.attrs.get("study", ""))
    refuse_if(name not in SUMMARIES, f"there is no summary of a study {name!r}")
    return SUMMARIES[name](study)


def _changes(study: Dataset) -> Summary:
    """Return the table of the changes of A0 and of the separation under each model, or by coupling.

    A study of other assignments of heights to sites has their rms changes too.
    """
    (names,) = (study[name].values for name in ("model", "substrate") if name in study.dims)
    load, change, last = study["load"].values, study["area_change"].values, study.isel(rescaled_load=-1)
    columns = {
        "model": names,
        "rms [%]": texts(".2f", 100.0 * np.sqrt((change**2).mean(axis=1))),
        "largest [%]": texts("+.2f", 100.0 * change[np.arange(len(names)), np.abs(change).argmax(axis=1)]),
    }
    for i in (int(np.abs(load - fraction * load[-1]).argmin()) for fraction in SHOWN_LOADS):
        columns[f"at {load[i]:.3g} N [%]"] = texts("+.2f", 100.0 * change[:, i])
    if "area" in study:
        columns["A0 [mm²]"] = texts(".5g", last["area"].values)
        columns["separation [µm]"] = texts(".2f", MICROMETRES * last["separation"].values)
    columns["glass lower by [µm]"] = texts("+.2f", MICROMETRES * last["sinking"].values)
    if "assignment_rms" in study:
        placed = 100.0 * study["assignment_rms"].values
        columns["random: median rms [%]"] = texts(".2f", np.median(placed, axis=1))
        columns["random: largest rms [%]"] = texts(".2f", placed.max(axis=1))
    title = f"Change of A0 from independent asperities; the last columns at {load[-1]:.3g} N"
    return Summary.of(study, title if "area" in study else f"{title}, or of {RANDOM}", columns)


def _manufacturing(study: Dataset) -> Summary:
    """Return the table of the slopes of surfaces whose heights have errors."""
    study, nominal = study.sortby("height_sd"), float(study["nominal_slope"])
    errors, words = MICROMETRES * study["height_sd"].values, "errors of the heights of up to {:.3g} µm (SD)"
    answer = _answer(study, errors, study["slope_sd"].values / nominal, words, "At {:.3g} µm (SD)")
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
    return Summary.of(study, title, columns, answer)


def _misalignment(study: Dataset) -> Summary:
    """Return the table of the scatter of the slope under tilts of the plane."""
    nominal, every = float(study["nominal_slope"]), study.isel(assignment=0)
    study = study.isel(angle=shown(study.sizes["angle"]))
    made, scatter = study.isel(assignment=0), study["slope_sd"].values / nominal
    columns = {
        "largest angle [°]": texts(".3g", np.degrees(study["angle"].values)),
        "mean slope": texts(".4f", made["slope_mean"].values),
        "SD of the slope [%]": texts(".3f", 100.0 * scatter[0]),
    }
    if "slope_sd_quantile" in study:
        quantile = 100.0 * study["slope_sd_quantile"].values / nominal
        for share, values in zip(study["quantile"].values, quantile, strict=True):
            columns[f"{100.0 * share:.0f} % of the assignments [%]"] = texts(".3f", values)
    median = ""
    if assigned := len(scatter) - 1:
        middle = percent(float(np.median(scatter[1:, -1])))
        median = f", and by {middle} in the median of {assigned} random assignments of the heights to sites"
    # without a tilt there is no scatter
    angle, values = (np.append(0.0, every[name].values) for name in ("angle", "slope_sd"))
    up_to, at = "tilts within ±{:.3g}°", "Within ±{:.3g}°"
    answer = _answer(made, np.degrees(angle), values / nominal, up_to, at, median)
    title = f"Slope of the law under tilts; {nominal:.4f} without a tilt"
    return Summary.of(study, title, columns, answer)


def _answer(
    study: Dataset, errors: FloatArray, scatter: FloatArray, up_to: str, at: str, more: str = ""
) -> str:
    """Return sentences on the errors that cause the allowed scatter, and on the effect of the largest.

    errors, scatter: (k,), increasing errors as they are printed, and the relative scatter of the slope. The
    error that causes the allowed scatter, the misfit up to which a design counts as reached, is interpolated.
    up_to, at: words for errors up to a value, and for one error.
    """
    last = study.isel(dict.fromkeys(study["slope_mean"].dims, -1))
    mean, sd = (float(last[f"slope_{moment}"] / last["nominal_slope"]) for moment in ("mean", "sd"))
    beyond = int(np.append(np.flatnonzero(scatter > REACHED), len(scatter))[0])
    even, sign, limit = "With", "less", float(errors[-1])
    if beyond == 0:
        even, sign, limit = "Even with", "more", float(errors[0])
    elif beyond < len(scatter):
        pair = slice(beyond - 1, beyond + 1)
        limit = float(np.interp(REACHED, scatter[pair], errors[pair]))
    return (
        f"{even} {up_to.format(limit)} the slope scatters by {sign} than {percent(REACHED)} (SD). "
        f"{at.format(errors[-1])} the slope scatters by {percent(sd)}{more}. "
        f"The mean slope changes there by {percent(round(mean - 1.0, 6), '+.2g')}."
    )


def shown(count: int) -> list[int]:
    """Return the rows to print: every n-th, counted back from the last row."""
    return list(range(count))[:: -math.ceil(count / MOST_ROWS)][::-1]


def _uncertainty(study: Dataset) -> Summary:
    """Return the table of the share of each input in the variance of the law."""
    names = [in_words(str(name)) for name in study["parameter"].values]
    quantity = main_quantity(study)
    first, total = shares(study, quantity, "first_order"), shares(study, quantity, "total")
    columns = {
        "input": [name.removeprefix("the ") for name in names],
        "alone [%]": texts(".1f", 100.0 * first),
        "with others [%]": texts(".1f", 100.0 * total),
    }
    if "slope_sd" in study:
        columns["of the slope [%]"] = texts(".1f", 100.0 * study["slope_total"].values)
        columns["its error [%]"] = texts(".1f", 100.0 * study["slope_total_error"].values)
    most = int(total.argmax())
    error_bar = study[f"{quantity}_sd"].values / study[f"{quantity}_mean"].values
    answer = (
        f"T{names[most][1:]} matters most: its error accounts for {100.0 * first[most]:.0f} % "
        f"of the variance of {QUANTITIES[quantity]}, whose error bar is {percent(float(error_bar[-1]))} (SD) "
        "at the largest load."
    )
    title = f"Share of each input in the variance of {QUANTITIES[quantity]}, over all loads"
    return Summary.of(study, title, columns, answer)


def main_quantity(study: Dataset) -> str:
    """Return the name of the most informative quantity in the study."""
    return next(name for name in QUANTITIES if f"{name}_sd" in study)


def shares(study: Dataset, name: str, index: str) -> FloatArray:
    """Return the Sobol indices (p,) of a quantity, averaged over the loads with the variance as weight."""
    variance = study[f"{name}_sd"].values ** 2
    return np.asarray(study[f"{name}_{index}"].values @ variance / variance.sum())


def in_words(label: str) -> str:
    """Return the words for a parameter, or for several correlated ones."""
    return " together with ".join(WORDS[name] for name in label.split(" + "))


SUMMARIES: Mapping[str, Callable[[Dataset], Summary]] = {
    "explained": explained_summary,
    "fidelity": _changes,
    "interaction": _changes,
    "manufacturing": _manufacturing,
    "measured": measured_summary,
    "misalignment": _misalignment,
    "uncertainty": _uncertainty,
}
