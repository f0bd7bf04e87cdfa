"""The summary of the study `uncertainty`: the share of each input in the variance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.studies.summaries.table import Summary, summarised, texts

if TYPE_CHECKING:
    from xarray import Dataset

# Words for the inputs; each begins with an article.
WORDS = {
    "radius": "the radius R",
    "composite_modulus": "the composite modulus E*",
    "load": "the load P",
    "friction_force": "the friction force F",
    "shear_strength": "the shear strength σ",
    "area_ratio": "the area ratio B",
}

# Quantities that a study may contain, the most informative first, in words.
QUANTITIES = {
    "deviation": "the difference between measured and predicted friction",
    "friction_force": "the friction force",
    "area": "the real contact area",
}


def uncertainty_summary(study: Dataset) -> Summary:
    """Return the table of the share of each input in the variance of the law, and a sentence."""
    names = study["parameter"].values.tolist()
    quantity = main_quantity(study)
    first, total = shares(study, quantity, "first_order"), shares(study, quantity, "total")
    columns = {
        "input": [in_words(name).removeprefix("the ") for name in names],
        "alone [%]": texts(".1f", 100.0 * first),
        "with others [%]": texts(".1f", 100.0 * total),
    }
    if "slope_sd" in study:
        columns["of the slope [%]"] = texts(".1f", 100.0 * study["slope_total"].values)
        columns["its error [%]"] = texts(".1f", 100.0 * study["slope_total_error"].values)
    most = int(total.argmax())
    several = " + " in names[most]
    matters = "matter most: their errors account" if several else "matters most: its error accounts"
    answer = (
        f"T{in_words(names[most])[1:]} {matters} for "
        f"{100.0 * first[most]:.0f} % of the variance of {QUANTITIES[quantity]}"
    )
    if quantity != "deviation":
        mean, sd = study[f"{quantity}_mean"].values, study[f"{quantity}_sd"].values
        answer += f", whose error bar is {percent(float((sd / mean)[-1]))} (SD) at the largest load"
    title = f"Share of each input in the variance of {QUANTITIES[quantity]}, over all loads"
    return summarised(study, title, columns, f"{answer}.")


def main_quantity(study: Dataset) -> str:
    """Return the name of the most informative quantity in the study."""
    return next(name for name in QUANTITIES if f"{name}_sd" in study)


def shares(study: Dataset, name: str, index: str) -> FloatArray:
    """Return the Sobol indices (p,) of a quantity, averaged over the loads with the variance as weight."""
    variance = study[f"{name}_sd"].values ** 2
    return np.asarray(study[f"{name}_{index}"].values @ variance / variance.sum())


def in_words(label: str) -> str:
    """Return the words for an input, or for several correlated inputs."""
    return " and ".join(WORDS.get(name, name) for name in label.split(" + "))
