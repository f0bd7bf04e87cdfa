"""The effect of manufacturing errors on the friction law of a surface."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.inversion import Design
from metafem.inversion.design import misfits
from metafem.models import Independent, Model
from metafem.models.model import checked_model
from metafem.notes import Note
from metafem.prediction import Tolerances
from metafem.progress import doing
from metafem.studies.dataset import QUANTILES, Variables, dataset
from metafem.studies.draws import computed, generator_of, seed_of
from metafem.studies.slope import range_note, slope, slope_loads
from metafem.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

# Number of draws of a batch; such a batch takes half a second on a bonded layer.
SIZE = 256

# Tolerances without errors.
EXACT = Tolerances()


@doing("drawing made surfaces")
def manufacturing(
    surface: Surface | Design,
    height_sd: ArrayLike,
    *,
    others: Tolerances = EXACT,
    draws: int = 10_000,
    model: Model | None = None,
    load_range: tuple[float, float] | None = None,
    rng: Any = 0,
) -> xr.Dataset:
    """Return mean and scatter of the friction law of surfaces with random manufacturing errors.

    Each draw adds independent Gaussian errors to the heights, radii and positions, and a uniform tilt, and
    the model computes the law of this surface. The slope m belongs to the straight line fitted to A0(P) at 20
    equally spaced loads. Source: Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234,
    Fig. S3. The batches are computed as `joblib.parallel_config` says.

    Parameters
    ----------
    surface : Surface or Design
        The laws of a design are also compared with its target.
    height_sd : float or array_like
        One or more standard deviations of the heights [mm], not negative. All use the same random numbers.
    others : Tolerances
        Errors in addition to those of the heights, such as ``Tolerances(radius_sd=0.001)``; default: none.
    draws : int
        Number of draws at each `height_sd`, at least 2; default: 10,000.
    model : Model, optional
        Default: independent asperities.
    load_range : (float, float), optional
        Rescaled loads P/E* between which the line is fitted [mm^2]. Default: 25 to 100 % of the load at which
        the plane reaches the lowest summit, with independent asperities. The source does not state its range.
    rng : int or numpy.random.Generator
        Seed or generator; default: 0.

    Returns
    -------
    xarray.Dataset
        ``slope_mean`` and ``slope_sd`` [-] over ``height_sd`` [mm]; ``area_mean`` and ``area_sd`` [mm^2] over
        ``height_sd`` and ``rescaled_load`` [mm^2]; each with its standard sampling error ``NAME_error``.
        ``slope_quantile`` is given at ``quantile`` .05, .5 and .95. ``nominal_slope`` and ``nominal_area``
        are the values without errors. ``draws`` and ``failed`` are the numbers of draws with and without a
        solution. Of a design, ``misfit_quantile`` has the quantiles of `Design.misfit`; a draw without a
        solution has an infinite misfit.

    Raises
    ------
    InvalidInput
        For negative standard deviations and fewer than two draws, and if all summits have the same height and
        no load range is given.
    NotConverged
        If the model has no solution for the surface itself, or for nearly all draws at a `height_sd`.

    Examples
    --------
    >>> import metafem as mf
    >>> height = [0.10, 0.12, 0.13, 0.15]
    >>> surface = mf.Surface.square_lattice(height, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> study = manufacturing(surface, [0.0, 0.001])
    >>> study.slope_sd.values.round(3)
    array([0.   , 0.046])
    """
    design, part = (surface, surface.surface) if isinstance(surface, Design) else (None, surface)
    used = checked_model(Independent() if model is None else model)
    deviations = check.array("height_sd", np.atleast_1d(height_sd), shape=(None,))
    count, seed = check.integer("draws", draws, at_least=2), seed_of(rng)
    load = slope_loads(part, load_range, used)
    every = load if design is None else np.union1d(load, _target_loads(design))
    nominal = used.curve(part, load).checked().area

    levels = []
    for sd in deviations.tolist():
        tolerances = replace(others, height_sd=sd)
        task = partial(_areas, part, used, tolerances, every, seed, count)
        area = np.concatenate(list(computed(task, range(math.ceil(count / SIZE)))))
        if np.isfinite(area).all(axis=1).sum() < 2:
            raise NotConverged(f"fewer than two draws have a solution with {tolerances}")
        levels.append(_statistics(design, every, area, load))
    variables: Variables = {
        name: (("height_sd", *axes), [level[name][1] for level in levels])
        for name, (axes, _) in levels[0].items()
    }
    variables["nominal_slope"] = (), slope(load, nominal)
    variables["nominal_area"] = ("rescaled_load",), nominal
    if design is not None:
        variables["nominal_misfit"] = (), design.misfit
    notes = [range_note(load)]
    if unsolved := sum(level["failed"][1] for level in levels):
        notes.insert(0, Note(f"{unsolved} draws have no solution under this model and are left out"))
    coordinates = {"height_sd": deviations, "rescaled_load": load, "quantile": QUANTILES}
    origin = {"model": repr(used), "load_range": load[[0, -1]].tolist(), "seed": str(seed), "draws": count}
    return dataset("manufacturing", variables, coordinates, notes, **origin)


def _areas(
    surface: Surface,
    model: Model,
    tolerances: Tolerances,
    load: FloatArray,
    seed: int,
    draws: int,
    batch: int,
) -> FloatArray:
    """Return A0 (m, k) [mm^2] of the made surfaces of a batch; nan without a solution."""
    size = min(SIZE, draws - batch * SIZE)
    return model.areas(surface, load, *tolerances.perturbed(surface, size, generator_of(seed, batch)))


def _statistics(design: Design | None, every: FloatArray, area: FloatArray, load: FloatArray) -> Variables:
    """Return the variables of one standard deviation of the heights.

    area: (m, j) [mm^2], of the made surfaces at the rescaled loads `every`; load: those of the slope.
    """
    solved = np.isfinite(area).all(axis=1)
    law = area[solved][:, np.searchsorted(every, load)]
    slopes = slope(load, law)
    found: Variables = {
        **_moments("slope", (), slopes),
        **_moments("area", ("rescaled_load",), law),
        "slope_quantile": (("quantile",), np.quantile(slopes, QUANTILES)),
        "failed": ((), len(area) - len(law)),
        "draws": ((), len(law)),
    }
    if design is not None:
        misfit = np.full(len(area), np.inf)
        misfit[solved] = _misfits(design, every, area[solved])
        found["misfit_quantile"] = ("quantile",), np.quantile(misfit, QUANTILES, method="inverted_cdf")
    return found


def _moments(name: str, axes: tuple[str, ...], value: FloatArray) -> Variables:
    """Return mean and standard deviation of draws (m, ...), and their sampling errors."""
    count, mean, sd = len(value), value.mean(axis=0), value.std(axis=0, ddof=1)
    fourth = ((value - mean) ** 4).mean(axis=0)
    error = np.sqrt(np.maximum(fourth - sd**4, 0.0) / count)  # of the variance
    sd_error = np.divide(error, 2.0 * sd, np.zeros_like(sd), where=sd > 0.0)
    return {
        f"{name}_mean": (axes, mean),
        f"{name}_mean_error": (axes, sd / np.sqrt(count)),
        f"{name}_sd": (axes, sd),
        f"{name}_sd_error": (axes, sd_error),
    }


def _target_loads(design: Design) -> FloatArray:
    """Return the rescaled loads [mm^2] of the target of a design and of its branches."""
    return np.concatenate([design.target_law.load, *(branch.load for branch, _ in design.fits)])


def _misfits(design: Design, load: FloatArray, area: FloatArray) -> FloatArray:
    """Return the misfits (m,) of laws from their areas (m, k) at the loads (k,)."""
    law, branches = design.target_law, [branch for branch, _ in design.fits]

    def at(loads: FloatArray) -> FloatArray:
        return area[:, np.searchsorted(load, loads)]

    slopes = np.array([slope(branch.load, at(branch.load)) for branch in branches]).reshape(-1, len(area)).T
    return misfits(law, branches, at(law.load) / law.laws(at(law.load)) - 1.0, slopes)
