"""What a study returns: a dataset with units, names and provenance, and the table that summarises it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem.notes import Note, from_lines, to_lines
from metafem.prediction.base_law import QUANTITIES

if TYPE_CHECKING:
    import xarray as xr

# Probabilities of the quantiles in the results.
QUANTILES = (0.05, 0.5, 0.95)

# Units and long names of the variables and coordinates that are not quantities of a law.
STUDIED: Mapping[str, tuple[str, str]] = {
    "slope": ("1", "slope of the law"),
    "area_change": ("1", "change of the real contact area from independent asperities"),
    "placement_rms": ("1", "root mean square change of the area of a random assignment"),
    "sinking": ("mm", "decrease of the separation by interaction"),
    "elements_error": ("1", "relative error of the table of caps"),
    "deviation": ("mm2", "rescaled friction less the predicted real contact area"),
    "stress": ("MPa", "friction force over rescaled friction, 0 for a law of areas"),
    "predicted": ("mm2", "rescaled friction of the design"),
    "chi_square": ("1", "sum of the squares of the normalised deviations"),
    "freedom": ("1", "degrees of freedom"),
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

# Attributes of every dataset: a study of several models has no model, and one without draws no seed.
PROVENANCE: Mapping[str, Any] = {"model": "", "load_range": [], "seed": "", "draws": 0}

# Variables by name, each with its dimensions and values.
Variables = dict[str, tuple[tuple[str, ...], Any]]


def described(name: str) -> dict[str, str]:
    """Return the units and the long name of a variable, such as ``area_sd_error`` or ``nominal_slope``.

    Examples
    --------
    >>> described("area_mean_error")
    {'units': 'mm2', 'long_name': 'real contact area A0, mean, standard sampling error'}
    """
    known, words = {**QUANTITIES, **STUDIED}, ["without errors"] * name.startswith("nominal_")
    base, share = name.removeprefix("nominal_"), False
    while base not in known:
        end = next((end for end in STATISTICS if base.endswith(f"_{end}")), None)
        if end is None:
            return {}
        base, share = base.removesuffix(f"_{end}"), share or end in SHARES
        words.insert(0, STATISTICS[end])
    unit, quantity = known[base]
    return {"units": "1" if share else unit, "long_name": ", ".join([quantity, *words])}


def dataset(
    study: str,
    variables: Variables,
    coordinates: Mapping[str, Any],
    notes: Iterable[Note],
    **provenance: Any,
) -> xr.Dataset:
    """Return the dataset of a study, with `PROVENANCE` as far as it is known."""
    import xarray as xr

    filled = {name: (axes, np.asarray(values), described(name)) for name, (axes, values) in variables.items()}
    axes = {name: (name, np.asarray(values), described(name)) for name, values in coordinates.items()}
    attributes = {"study": study, "notes": to_lines(notes), **PROVENANCE, **provenance}
    return xr.Dataset(filled, axes, attributes)


@dataclass(frozen=True)
class Summary:
    """The summary of a study: a table of texts, notes and a sentence.

    Attributes
    ----------
    title : str
    columns : tuple of str
        Headings.
    rows : tuple of tuple of str
    notes : tuple of Note
    answer : str
        What the study says about the part, in one sentence; empty for comparisons between models.

    Examples
    --------
    >>> Summary("Change of A0", ("model", "rms [%]"), (("layer", "0.21"),), ()).rows[0]
    ('layer', '0.21')
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[Note, ...]
    answer: str = ""

    @classmethod
    def of(cls, study: xr.Dataset, title: str, columns: Mapping[str, Any], answer: str = "") -> Summary:
        """Return the summary of a study from the columns of its table by their headings."""
        rows = tuple(zip(*(map(str, column) for column in columns.values()), strict=True))
        return cls(title, tuple(columns), rows, from_lines(str(study.attrs["notes"])), answer)


def texts(form: str, values: Iterable[float]) -> list[str]:
    """Return numbers as texts in the same format.

    Examples
    --------
    >>> texts("+.1f", [1.0, -0.26])
    ['+1.0', '-0.3']
    """
    return [f"{value:{form}}" for value in values]
