"""What the datasets of all studies of errors share: units, names and provenance."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem.models import Model
from metafem.notes import Note, to_lines
from metafem.studies.sampling.store import own_version

if TYPE_CHECKING:
    import xarray as xr

# Units and long names of variables and coordinates.
QUANTITIES: Mapping[str, tuple[str, str]] = {
    "slope_mean": ("1", "mean slope of the law"),
    "slope_sd": ("1", "standard deviation of the slope"),
    "slope_quantile": ("1", "quantile of the slope"),
    "area_mean": ("mm2", "mean real contact area"),
    "area_sd": ("mm2", "standard deviation of the real contact area"),
    "nominal_slope": ("1", "slope without errors"),
    "nominal_area": ("mm2", "real contact area without errors"),
    "failed": ("1", "number of draws without a solution"),
    "draws": ("1", "number of draws with a solution"),
    "saving": ("1", "plain draws of equal error over draws used"),
    "height_sd": ("mm", "standard deviation of the heights"),
    "angle": ("rad", "largest tilt"),
    "rescaled_load": ("mm2", "load over E*"),
    "quantile": ("1", "probability below the quantile"),
}


def described(name: str) -> dict[str, str]:
    """Return the units and the long name of a variable; ``NAME_error`` is the sampling error of NAME.

    Examples
    --------
    >>> described("area_mean_error")
    {'units': 'mm2', 'long_name': 'mean real contact area, standard sampling error'}
    """
    base = name.removesuffix("_error")
    if base not in QUANTITIES:
        return {}
    units, words = QUANTITIES[base]
    return {"units": units, "long_name": words if base == name else f"{words}, standard sampling error"}


def dataset(
    study: str,
    variables: Mapping[str, tuple[Iterable[str], Any]],
    coordinates: Mapping[str, Any],
    *,
    model: Model,
    load_range: tuple[float, float],
    seed: int,
    draws: int,
    inputs: str,
    notes: Iterable[Note] = (),
) -> xr.Dataset:
    """Return the dataset of a study; each variable is (dimensions, values).

    `inputs` is the hash of all that the numbers depend on, `draws` the largest number of draws of any point.
    """
    import xarray as xr

    filled = {
        name: (tuple(axes), np.asarray(values), described(name)) for name, (axes, values) in variables.items()
    }
    axes = {name: (name, np.asarray(values), described(name)) for name, values in coordinates.items()}
    attributes = {
        "study": study,
        "notes": to_lines(list(notes)),
        "model": repr(model),
        "load_range": list(load_range),
        "seed": str(seed),
        "draws": draws,
        "inputs": inputs,
        "metafem": own_version(),
    }
    return xr.Dataset(filled, axes, attributes)
