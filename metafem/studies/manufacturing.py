"""The effect of manufacturing errors on the friction law of a surface."""

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

# Tolerances without errors.
EXACT = Tolerances()

# Number of points of a batch if draws are added until an error is reached. It is small, because the first
# round already has 16 batches.
ROUND_POINTS = 16

# Number of batches that are added before the errors are computed again.
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
    """Return mean and scatter of the friction law of surfaces with random manufacturing errors.

    Each draw adds independent Gaussian errors to the heights, radii and positions, and the model computes the
    law of this surface. The slope m belongs to the straight line fitted to A0(P) at 20 equally spaced loads.
    Source: Aymard et al., Science 383, 200 (2024), doi:10.1126/science.adk4234, Fig. S3.

    The draws are Sobol points in independently scrambled batches. The linear response
    ``dm = sum_i dm/dh_i dh_i`` has known moments and serves as control variate for the mean and the second
    moment. Sobol points and control variates reduce the number of draws that a sampling error requires;
    `saving` states by which factor.

    The study also computes the largest standard deviation of the heights at which the slope scatters by less
    than 1 %. This limit does not depend on `height_sd`. Its computation takes as long as about 4, and at most
    21, further values of `height_sd`.

    Parameters
    ----------
    surface : Surface
    height_sd : float or array_like
        One or more standard deviations of the heights [mm], not negative. All use the same random numbers.
    draws : int or metafem.studies.Draws
        Number of draws at each `height_sd`, at least 2, rounded up to full batches; default: 10,000. With
        ``Draws(error=...)``, draws are added until `slope_sd` has this relative error at each `height_sd`.
    model : Model, optional
        Default: independent asperities.
    load_range : (float, float), optional
        Rescaled loads P/E* between which the line is fitted [mm^2]. Default: 25 to 100 % of the load at which
        the plane reaches the lowest summit, with independent asperities. The source does not state its range.
    others : Tolerances
        Errors in addition to those of the heights, such as ``Tolerances(radius_sd=0.001)``; default: none.
        They include errors of the shape of power caps.
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
        without errors. ``draws`` and ``failed`` are the numbers of draws with and without a solution.
        ``saving`` is the number of plain random draws that give the same error, divided by the number of
        draws used, for the ``moment`` "mean" and "sd" of the slope. ``slope_quantile_error`` is the error
        that plain random draws would have. ``largest_height_sd`` [mm] is the value at which `slope_sd` equals
        ``allowed_scatter``, 1 % of the nominal slope. It is nan if the other errors already cause a larger
        scatter, and infinite if no such value is found. With fewer than 16 draws its error is infinite.

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
    """Return the standard deviation of the heights at which the slope scatters by `ALLOWED`, and its error.

    Both are in mm. error: as for `summed`.
    """

    def scatter(height_sd: float) -> Estimate:
        """Return the relative standard deviation of the slope; infinite if too few batches are solved."""
        sums = summed(compute, replace(task, tolerances=replace(task.tolerances, height_sd=height_sd)), error)
        if sums["batches"] < FEWEST_BATCHES:
            return Estimate(math.inf, math.inf)
        found = moments(sums, plain=task.plain)
        return Estimate(float(found.value[1, 0]), float(found.error[1, 0]))

    if error is None and task.draws < FEWEST_BATCHES:
        return Estimate(0.0, math.inf)
    # start at half the value from the linear response, but at most at the fraction ALLOWED of the mean radius
    response = float(np.linalg.norm(task.response[0]))
    most = ALLOWED * float(task.surface.radius.mean())
    start = min(0.5 * ALLOWED / response, most) if response > 0.0 else most
    found = largest(lambda factor: scatter(factor * start), scatter(start), ALLOWED, MOST)
    return Estimate(found.value * start, found.error * start)


@dataclass(frozen=True, eq=False)
class SlopeDraws:
    """Batches of surfaces with random errors of given tolerances, and the sums of their slopes and areas.

    All tolerances use the same points (common random numbers). The quantities (q,) are the slope and the
    areas at the loads of the fit, each divided by its nominal value.
    """

    surface: Surface
    model: Model
    slope: Slope
    tolerances: Tolerances
    nominal: FloatArray  # (q,)
    response: FloatArray  # (q, n), derivatives of the quantities with respect to the heights [1/mm]
    seed: int
    size: int
    draws: int  # with plain random numbers, the last batch may be smaller
    plain: bool
    dimensions: int  # coordinates of a point; those of the heights come first, unused without height errors

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
        areas = self.tolerances.areas(self.model, self.surface, self.slope.load, unit)
        # no matrix product: its last bits would depend on the number of threads
        slopes = np.einsum("mk,k->m", areas, self.slope.weight)
        difference = np.column_stack([slopes, areas]) / self.nominal - 1.0
        height = self.tolerances.perturbed(self.surface, unit).height
        response = np.einsum("mn,qn->mq", height - self.surface.height, self.response)
        response /= np.where(self.scale > 0.0, self.scale, 1.0)
        return sums_of(difference, response)


def linear_response(model: Model, surface: Surface, slope: Slope) -> tuple[FloatArray, FloatArray]:
    """Return slope and areas (q,), and their relative derivatives with respect to the heights (q, n) [1/mm].

    Raise NotConverged if the model has no solution for the surface.
    """
    curve = model.curve(surface, slope.load).checked()
    nominal = np.concatenate([[slope.weight @ curve.area], curve.area])
    gradient = _gradient(model, surface, slope.load)
    return nominal, np.vstack([slope.weight @ gradient, gradient]) / nominal[:, None]


def _gradient(model: Model, surface: Surface, load: FloatArray) -> FloatArray:
    """Return dA0/dh (k, n) [mm], with 0 where it is unknown: a control variate of 0 has no effect."""
    try:
        found = model.gradient_model.sensitivity(surface, load).gradient
    except (MetafemError, np.linalg.LinAlgError):  # order 3 may have no solution where resolved contacts do
        return np.zeros((len(load), surface.count))
    return np.where(np.isfinite(found).all(axis=1, keepdims=True), found, 0.0)


def summed(compute: Run, task: SlopeDraws, error: float | None = None) -> Sums:
    """Return the sums over all batches.

    If `error` is given, rounds of `ROUND_BATCHES` batches are added until the standard deviation of the slope
    has this relative error.
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
