"""Units, names and provenance of the datasets of all studies."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from metafem.models import Model
from metafem.notes import Note, to_lines
from metafem.studies.sampling.slope import Slope

if TYPE_CHECKING:
    import xarray as xr

# Probabilities of the quantiles in the results.
QUANTILES = (0.05, 0.5, 0.95)

# Units and long names of the studied quantities, and of the other variables and coordinates.
QUANTITIES: Mapping[str, tuple[str, str]] = {
    "slope": ("1", "slope of the law"),
    "area": ("mm2", "real contact area"),
    "friction_force": ("N", "friction force"),
    "load": ("N", "normal load"),
    "rescaled_load": ("mm2", "load over E*"),
    "separation": ("mm", "plane to undeformed base plane"),
    "area_change": ("1", "change of the real contact area from independent asperities"),
    "centred_change": ("1", "change of the area, tallest asperities in the centre"),
    "placement_rms": ("1", "root mean square change of the area of a random assignment"),
    "sinking": ("mm", "decrease of the separation by interaction"),
    "elements_error": ("1", "relative error of the table of caps"),
    "rescaled_friction": ("mm2", "friction force over shear strength and area ratio"),
    "deviation": ("mm2", "rescaled friction less the predicted real contact area"),
    "stress": ("MPa", "friction force over rescaled friction, 0 for a law of areas"),
    "predicted": ("mm2", "rescaled friction of the design"),
    "chi_square": ("1", "sum of the squares of the normalised deviations"),
    "freedom": ("1", "degrees of freedom"),
    "runs": ("1", "runs of deviations of one sign"),
    "failed": ("1", "number of draws without a solution"),
    "draws": ("1", "number of draws with a solution"),
    "misfit": ("1", "relative deviation from the target"),
    "height_sd": ("mm", "standard deviation of the heights"),
    "angle": ("rad", "largest tilt"),
    "quantile": ("1", "probability below the quantile"),
}

# Statistics in words, by the suffix of the variable's name.
STATISTICS: Mapping[str, str] = {
    "mean": "mean",
    "sd": "standard deviation",
    "quantile": "quantile",
    "first_order": "share of the variance that the parameter explains alone",
    "total": "share of the variance that remains if all other parameters are known",
    "error": "standard sampling error",
}

# Statistics that are shares of the variance; they have no unit, whatever the quantity.
SHARES = ("first_order", "total")


def described(name: str) -> dict[str, str]:
    """Return the units and the long name of a variable, such as ``area_sd_error`` or ``nominal_slope``.

    Examples
    --------
    >>> described("area_mean_error")
    {'units': 'mm2', 'long_name': 'real contact area, mean, standard sampling error'}
    """
    words: list[str] = []
    base, share = name.removeprefix("nominal_"), False
    while base not in QUANTITIES:
        end = next((end for end in STATISTICS if base.endswith(f"_{end}")), None)
        if end is None:
            return {}
        base, share = base.removesuffix(f"_{end}"), share or end in SHARES
        words.insert(0, STATISTICS[end])
    units, quantity = QUANTITIES[base]
    words += ["without errors"] * name.startswith("nominal_")
    return {"units": "1" if share else units, "long_name": ", ".join([quantity, *words])}


# Variables by name, each with its dimensions and values.
Variables = dict[str, tuple[tuple[str, ...], Any]]


class Estimate(NamedTuple):
    """An estimate and its standard sampling error, of the same shape."""

    value: Any
    error: Any


def with_error(name: str, axes: tuple[str, ...], estimate: Iterable[Any]) -> Variables:
    """Return the variables of an estimate and of its sampling error."""
    value, error = estimate
    return {name: (axes, value), f"{name}_error": (axes, error)}


def dataset(
    study: str,
    variables: Mapping[str, tuple[Iterable[str], Any]],
    coordinates: Mapping[str, Any],
    *,
    model: Model | None = None,
    slope: Slope | None = None,
    seed: int | None = None,
    draws: int | None = None,
    notes: Iterable[Note] = (),
) -> xr.Dataset:
    """Return the dataset of a study; each variable is (dimensions, values).

    `draws` is the largest number of draws at any point. A study of several models has no `model`. A study
    without random numbers has no `seed` and no `draws`.
    """
    import xarray as xr

    filled = {
        name: (tuple(axes), np.asarray(values), described(name)) for name, (axes, values) in variables.items()
    }
    axes = {name: (name, np.asarray(values), described(name)) for name, values in coordinates.items()}
    attributes = {
        "study": study,
        "notes": to_lines(list(notes)),
        "model": "" if model is None else repr(model),
        "load_range": [] if slope is None else list(slope.load_range),
        "seed": "" if seed is None else str(seed),
        "draws": 0 if draws is None else draws,
    }
    return xr.Dataset(filled, axes, attributes)
