"""The effect of manufacturing errors on the friction law of a surface."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.inversion import Design
from metafem.models import Independent, Model
from metafem.models.model import checked_model
from metafem.notes import Note
from metafem.prediction import Tolerances
from metafem.progress import doing
from metafem.studies.made_laws import SIZE, MadeLaws, law_loads, law_misfits
from metafem.studies.sampling.batches import computed
from metafem.studies.sampling.dataset import QUANTILES, Estimate, Variables, dataset, with_error
from metafem.studies.sampling.points import entropy
from metafem.studies.sampling.slope import Slope
from metafem.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

# Tolerances without errors.
EXACT = Tolerances()


@doing("drawing made surfaces")
def manufacturing(
    surface: Surface,
    height_sd: ArrayLike,
    *,
    others: Tolerances = EXACT,
    design: Design | None = None,
    draws: int = 10_000,
    model: Model | None = None,
    load_range: Any = None,
    rng: Any = 0,
) -> xr.Dataset:
    """Return mean and scatter of the friction law of surfaces with random manufacturing errors.

    Each draw adds independent Gaussian errors to the heights, radii and positions, and a uniform tilt, and
    the model computes the law of this surface. The slope m belongs to the straight line fitted to A0(P) at 20
    equally spaced loads. Source: Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234,
    Fig. S3. The batches are computed as `joblib.parallel_config` says.

    Parameters
    ----------
    surface : Surface
    height_sd : float or array_like
        One or more standard deviations of the heights [mm], not negative. All use the same random numbers.
    others : Tolerances
        Errors in addition to those of the heights, such as ``Tolerances(radius_sd=0.001)``; default: none.
        They include a tilt, and errors of the shape of power caps.
    design : Design, optional
        Design of this surface; the laws are then also compared with its target. Default: None.
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
        solution. With a design, ``misfit_quantile`` has the quantiles of the misfit from its target, which is
        defined as `Design.misfit`; a draw without a solution has an infinite misfit.

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
    used = checked_model(Independent() if model is None else model)
    deviations = np.atleast_1d(check.array("height_sd", np.atleast_1d(height_sd), shape=(None,)))
    tolerances = tuple(replace(others, height_sd=float(sd)) for sd in deviations)
    count, seed = check.integer("draws", draws, at_least=2), entropy(rng)
    slope = Slope.of(surface, load_range, used)
    loads = [slope.load] if design is None else [slope.load, law_loads(design)]
    every = np.unique(np.concatenate(loads))
    nominal = _quantities(used.curve(surface, slope.load).checked().area[None], slope)[0]
    dimensions = replace(others, height_sd=1.0).dimensions(surface)
    notes, levels, misfit, failed = [], [], [], []
    for each in tolerances:
        task = MadeLaws(surface, used, each, every, seed, count, dimensions)
        area = np.concatenate(list(computed(task, range(-(-count // SIZE)))))
        solved = np.isfinite(area).all(axis=1)
        if solved.sum() < 2:
            words = f"fewer than two draws have a solution at height_sd = {each.height_sd:g} mm"
            raise NotConverged(words)
        failed.append(int((~solved).sum()))
        levels.append(_quantities(area[solved][:, np.searchsorted(every, slope.load)], slope))
        if design is not None:
            misfit.append(law_misfits(design, every, area))
    if any(failed):
        notes.append(Note(f"{sum(failed)} draws have no solution under this model and are left out"))
    variables: Variables = {
        "nominal_slope": ((), nominal[0]),
        "nominal_area": (("rescaled_load",), nominal[1:]),
        "slope_quantile": (("height_sd", "quantile"), [np.quantile(y[:, 0], QUANTILES) for y in levels]),
        "failed": (("height_sd",), failed),
        "draws": (("height_sd",), [len(y) for y in levels]),
    }
    for name, estimates in zip(("mean", "sd"), zip(*map(_moments, levels), strict=True), strict=True):
        value, error = np.moveaxis(np.array(estimates), 1, 0)
        variables |= with_error(f"slope_{name}", ("height_sd",), (value[:, 0], error[:, 0]))
        variables |= with_error(f"area_{name}", ("height_sd", "rescaled_load"), (value[:, 1:], error[:, 1:]))
    if design is not None:
        found = [np.quantile(each, QUANTILES, method="inverted_cdf") for each in misfit]
        variables["misfit_quantile"] = ("height_sd", "quantile"), found
        variables["nominal_misfit"] = (), design.misfit
    coordinates = {"height_sd": deviations, "rescaled_load": slope.load, "quantile": QUANTILES}
    notes.append(slope.note)
    return dataset(
        "manufacturing", variables, coordinates, model=used, slope=slope, seed=seed, draws=count, notes=notes
    )


def _quantities(area: FloatArray, slope: Slope) -> FloatArray:
    """Return slopes and areas (m, 1 + k) from the areas (m, k) at the loads of the slope."""
    # no matrix product: its last bits would depend on the number of threads
    return np.column_stack([np.einsum("mk,k->m", area, slope.weight), area])


def _moments(value: FloatArray) -> tuple[Estimate, Estimate]:
    """Return means and standard deviations of draws (m, q), with their sampling errors."""
    count, mean, sd = len(value), value.mean(axis=0), value.std(axis=0, ddof=1)
    fourth = ((value - mean) ** 4).mean(axis=0)
    error = np.sqrt(np.maximum(fourth - sd**4, 0.0) / count)
    return (
        Estimate(mean, sd / np.sqrt(count)),
        Estimate(sd, np.divide(error, 2.0 * sd, np.zeros_like(sd), where=sd > 0.0)),
    )
