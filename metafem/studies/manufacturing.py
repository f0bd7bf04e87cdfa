"""The effect of errors of the made surface on its friction law."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import MetafemError, NotConverged
from metafem.models import Independent, Model
from metafem.models.model import checked_model
from metafem.notes import Note
from metafem.prediction import Tolerances
from metafem.progress import doing
from metafem.studies.largest_tolerances import ALLOWED, MOST, largest
from metafem.studies.sampling.batches import Execution, Run, opened
from metafem.studies.sampling.dataset import QUANTILES, dataset, of_law, with_error
from metafem.studies.sampling.moments import Estimate, Sums, added, moments, quantiles, sums_of
from metafem.studies.sampling.points import (
    FEWEST_BATCHES,
    MOST_DRAWS,
    Draws,
    batch_size,
    entropy,
    unit_points,
)
from metafem.studies.sampling.slope import Slope
from metafem.studies.sampling.store import inputs_hash
from metafem.surface import Surface

if TYPE_CHECKING:
    import xarray as xr

# No errors.
EXACT = Tolerances()

# Points of a batch if the number of draws follows from the wanted error: 16 batches are then few draws.
ROUND_POINTS = 16

# Number of batches added before the errors are computed again.
ROUND_BATCHES = 8


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
    used = checked_model(Independent() if model is None else model)
    deviations = np.atleast_1d(check.array("height_sd", np.atleast_1d(height_sd), shape=(None,)))
    tolerances = tuple(replace(others, height_sd=float(sd)) for sd in deviations)
    wanted, seed, slope = Draws.of(draws), entropy(rng), Slope.of(surface, load_range, used)
    error, plain = wanted.error, wanted.plain
    dimensions = replace(others, height_sd=1.0).dimensions(surface)
    size = batch_size(wanted.number, dimensions) if error is None else ROUND_POINTS
    task = SlopeDraws(
        surface, used, slope, others, *linear_response(used, surface, slope), seed, size, wanted.number,
        plain, dimensions,
    )  # fmt: skip
    own = (surface, used, slope.load_range, tolerances, seed, size, wanted)
    inputs = inputs_hash(("manufacturing", *own))
    with opened(execution, "manufacturing", inputs) as compute:
        levels = [summed(compute, replace(task, tolerances=each), error) for each in tolerances]
        limit = _largest_height_sd(compute, task, error)
    count, failed, batches = (
        np.array([sums[name] for sums in levels]) for name in ("count", "failed", "batches")
    )
    for deviation in deviations[batches < 2]:
        raise NotConverged(f"fewer than two batches of draws have a solution at height_sd = {deviation:g} mm")
    found = [moments(sums, plain=plain) for sums in levels]
    value, errors, saving = (np.array(parts) for parts in zip(*found, strict=True))
    quantile = np.array([quantiles(sums, np.array(QUANTILES)) for sums in levels]).swapaxes(0, 1)
    notes = []
    if failed.any():
        notes.append(Note(f"{failed.sum()} draws have no solution under this model and are left out"))
    if error is not None and (errors[:, 1, 0] > error * value[:, 1, 0]).any():
        notes.append(
            Note(f"the relative error {error:g} of slope_sd is not reached within {count.max()} draws")
        )
    notes.append(slope.note)
    variables = {
        **of_law((value, errors), task.nominal, ("height_sd",)),
        **with_error("slope_quantile", ("height_sd", "quantile"), quantile, task.nominal[0], 1.0),
        **with_error("largest_height_sd", (), limit),
        "saving": (("height_sd", "moment"), saving[..., 0]),
        "failed": (("height_sd",), failed),
        "draws": (("height_sd",), count),
    }
    coordinates = {
        "height_sd": deviations,
        "rescaled_load": slope.load,
        "quantile": QUANTILES,
        "moment": ["mean", "sd"],
    }
    return dataset(
        "manufacturing", variables, coordinates, model=used, slope=slope, seed=seed,
        draws=int(count.max()), inputs=inputs, notes=notes,
    ).assign_attrs(allowed_scatter=ALLOWED)  # fmt: skip


def _largest_height_sd(compute: Run, task: SlopeDraws, error: float | None) -> Estimate:
    """Return the deviation of the heights at which the slope scatters by `ALLOWED`, and its error [mm].

    error: as for `summed`.
    """

    def scatter(height_sd: float) -> Estimate:
        """Return the relative deviation of the slope; infinite without enough solutions for its error."""
        sums = summed(compute, replace(task, tolerances=replace(task.tolerances, height_sd=height_sd)), error)
        if sums["batches"] < FEWEST_BATCHES:
            return Estimate(math.inf, math.inf)
        found = moments(sums, plain=task.plain)
        return Estimate(float(found.value[1, 0]), float(found.error[1, 0]))

    if error is None and task.draws < FEWEST_BATCHES:
        return Estimate(0.0, math.inf)
    # half the value by linear response, and not more than the same fraction of the radius
    response = float(np.linalg.norm(task.response[0]))
    most = ALLOWED * float(task.surface.radius.mean())
    start = min(0.5 * ALLOWED / response, most) if response > 0.0 else most
    found = largest(lambda factor: scatter(factor * start), scatter(start), ALLOWED, MOST)
    return Estimate(found.value * start, found.error * start)


@dataclass(frozen=True, eq=False)
class SlopeDraws:
    """The batches of a study of one surface with given tolerances.

    The points are the same for all tolerances (common random numbers). The quantities (q,) are the slope and
    the areas at its loads, each over its nominal value.
    """

    surface: Surface
    model: Model
    slope: Slope
    tolerances: Tolerances
    nominal: FloatArray  # (q,)
    response: FloatArray  # (q, n), derivatives of the quantities by the heights, over the nominal values
    seed: int
    size: int
    draws: int  # the last batch of plain draws may be smaller
    plain: bool
    dimensions: int  # of the points; heights come first and are left out if they have no errors

    @cached_property
    def scale(self) -> FloatArray:
        """Standard deviations of the linear responses, (q,)."""
        return np.sqrt(np.diag(self.tolerances.linear_covariance(self.surface, self.response)))

    def __call__(self, batch: int) -> Sums:
        """Return the sums of one batch."""
        size = min(self.size, self.draws - batch * self.size) if self.plain else self.size
        own = self.tolerances.dimensions(self.surface)
        if own == 0:
            return sums_of(*np.zeros((2, size, len(self.nominal))))
        points = unit_points(self.seed, batch, size, self.dimensions, plain=self.plain)
        unit = points[:, self.dimensions - own :]
        height, radius, position = self.tolerances.perturbed(self.surface, unit)
        areas = self.model.areas(self.surface, self.slope.load, height, radius, position)
        # no products of matrices: their last bits depend on the number of threads
        slopes = np.einsum("mk,k->m", areas, self.slope.weight)
        difference = np.column_stack([slopes, areas]) / self.nominal - 1.0
        response = np.einsum("mn,qn->mq", height - self.surface.height, self.response)
        response /= np.where(self.scale > 0.0, self.scale, 1.0)
        return sums_of(difference, response)


def linear_response(model: Model, surface: Surface, slope: Slope) -> tuple[FloatArray, FloatArray]:
    """Return the slope and the areas (q,), and their derivatives by the heights over these (q, n).

    NotConverged is raised if the model has no solution for the surface.
    """
    curve = model.curve(surface, slope.load).checked()
    nominal = np.concatenate([[slope.weight @ curve.area], curve.area])
    gradient = _gradient(model, surface, slope.load)
    return nominal, np.vstack([slope.weight @ gradient, gradient]) / nominal[:, None]


def _gradient(model: Model, surface: Surface, load: FloatArray) -> FloatArray:
    """Return dA0/dh (k, n) [mm]; any finite one is a control variate, zero has no effect."""
    try:
        found = model.gradient_model.sensitivity(surface, load).gradient
    except (MetafemError, np.linalg.LinAlgError):  # resolved contacts may have a solution if order 3 has none
        return np.zeros((len(load), surface.count))
    return np.where(np.isfinite(found).all(axis=1, keepdims=True), found, 0.0)


def summed(compute: Run, task: SlopeDraws, error: float | None = None) -> Sums:
    """Return the sums over all batches.

    With `error` batches are added in fixed rounds until the slope's standard deviation has this relative
    error.
    """
    total: Sums = {}
    first, last = 0, -(-task.draws // task.size) if error is None else FEWEST_BATCHES
    while True:
        for batch in compute(task, range(first, last)):
            total = added(total, batch)
        if error is None or last * task.size >= MOST_DRAWS:
            return total
        found = moments(total)
        if not found.error[1, 0] > error * found.value[1, 0]:
            return total
        first, last = last, last + ROUND_BATCHES
