"""The effect of errors of the made surface on its friction law."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem.errors import NotConverged
from metafem.models import Independent, Model
from metafem.models.model import checked_model
from metafem.notes import Note
from metafem.prediction import Tolerances
from metafem.progress import doing
from metafem.studies.largest_tolerances import ALLOWED, MOST, Largest, Level, largest
from metafem.studies.sampling.batches import Execution, opened
from metafem.studies.sampling.dataset import QUANTILES, dataset, of_law, with_error
from metafem.studies.sampling.draws import ROUND_POINTS, SlopeDraws, linear_response, summed
from metafem.studies.sampling.moments import Sums, moments, quantiles
from metafem.studies.sampling.points import FEWEST_BATCHES, Draws, batch_size, entropy
from metafem.studies.sampling.schedulers import Run
from metafem.studies.sampling.slope import Slope
from metafem.studies.sampling.store import inputs_hash
from metafem.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

# No errors.
EXACT = Tolerances()


@doing("drawing made surfaces")
def manufacturing(
    surface: Surface,
    height_sd: ArrayLike,
    *,
    draws: int | Draws = 10_000,
    model: Model | None = None,
    load_range: Any = None,
    others: Tolerances = EXACT,
    rng: Any = 0,
    execution: Execution | None = None,
) -> xr.Dataset:
    """Mean and scatter of the friction law of surfaces whose heights, radii and positions have errors.

    Each draw adds independent Gaussian errors to the surface, and the model solves for its law. The slope
    m is that of the straight line fitted to A0(P) over 20 equally spaced loads of a range. Aymard et al.,
    Science 383, 200 (2024), doi:10.1126/science.adk4234, Fig. S3.

    The draws are Sobol points, in batches that are scrambled independently. The linear response
    ``dm = sum_i dm/dh_i dh_i`` has known moments and serves as control variate for the mean and the second
    moment. Both reduce the number of draws for the same sampling error; `saving` states the factor.

    The largest standard deviation of the heights at which the slope scatters by less than 1 % is computed
    with the same random numbers, for any `height_sd`. This takes as long as about 4 further values of
    `height_sd`, and at most 21.

    Parameters
    ----------
    surface : Surface
    height_sd : float or array_like
        Standard deviations of the heights [mm], one or many, not negative. All use the same random numbers.
    draws : int or metafem.studies.Draws
        Number of draws at each value, at least 2, rounded up to whole batches; default: 10,000. With an
        error, draws are added until `slope_sd` has this relative error at each value of `height_sd`.
    model : Model, optional
        Default: independent asperities.
    load_range : (float, float), optional
        Range of the rescaled load of the fit [mm^2]. Default: 25 to 100 % of the load at which the plane
        reaches the lowest summit, under independent asperities. The paper does not print its range.
    others : Tolerances
        Errors besides those of the heights, such as ``Tolerances(radius_sd=0.001)``; default: none.
    rng : int or numpy.random.Generator
        Seed or generator; default: 0.
    execution : metafem.studies.Execution, optional
        Processes or cluster, and folder of a run that can be resumed; default: this process.

    Returns
    -------
    xarray.Dataset
        ``slope_mean`` and ``slope_sd`` [-] over ``height_sd`` [mm]; ``area_mean`` and ``area_sd`` [mm^2] over
        ``height_sd`` and ``rescaled_load`` [mm^2]; ``slope_quantile`` at ``quantile`` .05, .5 and .95; each
        with its standard sampling error ``NAME_error``. ``nominal_slope`` and ``nominal_area`` are the values
        without errors, ``draws`` the draws with a solution, ``failed`` those without. ``saving`` is the
        number of plain draws of equal error over the draws used, for the ``moment`` "mean" and "sd" of the
        slope. ``slope_quantile_error`` is the error of plain draws. ``largest_height_sd`` [mm] is the value
        at which `slope_sd` equals ``allowed_scatter``, 1 % of the nominal slope: nan if the other errors
        already cause more, and infinite if no such value is found. Its error is infinite with fewer than 16
        draws.

    Raises
    ------
    InvalidInput
        For negative deviations, fewer than two draws, and a surface whose summits have one height without a
        load range.
    NotConverged
        If the model has no solution for the surface itself, or for nearly all draws of a deviation.

    Examples
    --------
    >>> import metafem as mf
    >>> height = [0.10, 0.12, 0.13, 0.15]
    >>> surface = mf.Surface.square_lattice(height, (2, 2), radius=0.526, material=mf.Material(1.36))
    >>> study = manufacturing(surface, [0.0, 0.001], draws=200)
    >>> study.slope_sd.values.round(3)
    array([0.   , 0.041])
    """
    check.instance("surface", surface, Surface, "a metafem.Surface")
    used = checked_model(Independent() if model is None else model)
    deviations = np.atleast_1d(check.array("height_sd", np.atleast_1d(height_sd), shape=(None,)))
    tolerances = tuple(replace(others, height_sd=float(sd)) for sd in deviations)
    wanted, seed, slope = Draws.of(draws), entropy(rng), Slope.of(surface, load_range, used)
    error, plain = wanted.error, wanted.plain
    dimensions = replace(others, height_sd=1.0).dimensions(surface)
    size = batch_size(wanted.number, dimensions) if error is None else ROUND_POINTS
    task = SlopeDraws(
        surface, used, slope, tolerances, *linear_response(used, surface, slope), seed, size, wanted.number,
        plain, (True,) * len(tolerances),
    )  # fmt: skip
    own = (surface, used, slope.load_range, tolerances, seed, size, wanted)
    inputs = inputs_hash(("manufacturing", *own))
    with opened(execution, "manufacturing", inputs) as compute:
        sums, done = summed(compute, task, error)
        limit = _largest_height_sd(compute, task, done, error)
    for deviation in deviations[sums.batches < 2]:
        raise NotConverged(f"fewer than two batches of draws have a solution at height_sd = {deviation:g} mm")
    found, levels = moments(sums, plain=plain), quantiles(sums, np.array(QUANTILES))
    nominal = task.nominal[0]
    notes = []
    if sums.failed.any():
        notes.append(Note(f"{sums.failed.sum()} draws have no solution under this model and are left out"))
    if error is not None and (found.sd.error[:, 0] > error * found.sd.value[:, 0]).any():
        notes.append(
            Note(f"the relative error {error:g} of slope_sd is not reached within {sums.count.max()} draws")
        )
    notes.append(slope.note)
    saving = np.column_stack([found.saving_of_mean[:, 0], found.saving_of_sd[:, 0]])
    variables = {
        **of_law(found, task.nominal, ("height_sd",)),
        **with_error("slope_quantile", ("height_sd", "quantile"), levels, nominal, 1.0),
        **with_error("largest_height_sd", (), limit[:2]),
        "saving": (("height_sd", "moment"), saving),
        "failed": (("height_sd",), sums.failed),
        "draws": (("height_sd",), sums.count),
    }
    coordinates = {
        "height_sd": deviations,
        "rescaled_load": slope.load,
        "quantile": QUANTILES,
        "moment": ["mean", "sd"],
    }
    return dataset(
        "manufacturing", variables, coordinates, model=used, load_range=slope.load_range, seed=seed,
        draws=int(sums.count.max()), inputs=inputs, notes=notes,
    ).assign_attrs(allowed_scatter=ALLOWED)  # fmt: skip


def _largest_height_sd(compute: Run, task: SlopeDraws, first: int, error: float | None) -> Largest:
    """Return the deviation of the heights at which the slope scatters by `ALLOWED`, and its error [mm].

    first: number of the first batch that is free; error: as for `summed`.
    """
    others = replace(task.tolerances[0], height_sd=0.0)

    def scatter(height_sd: float) -> Level:
        nonlocal first
        sums, first = summed(compute, task.at(replace(others, height_sd=height_sd), first), error)
        return _scatter(sums, task.plain)

    if error is None and task.draws < FEWEST_BATCHES:
        return Largest(0.0, math.inf)
    # half the value by linear response, and not more than the same fraction of the radius
    response = float(np.linalg.norm(task.response[0]))
    most = ALLOWED * float(task.surface.radius.mean())
    start = min(0.5 * ALLOWED / response, most) if response > 0.0 else most
    found = largest(lambda factor: scatter(factor * start), scatter(start), ALLOWED, MOST)
    return Largest(found.factor * start, found.error * start)


def _scatter(sums: Sums, plain: bool) -> Level:
    """Return the relative deviation of the slope; it is infinite without enough solutions for its error."""
    if sums.batches[0] < FEWEST_BATCHES:
        return Level(math.inf, math.inf)
    found = moments(sums, plain=plain).sd
    return Level(float(found.value[0, 0]), float(found.error[0, 0]))
