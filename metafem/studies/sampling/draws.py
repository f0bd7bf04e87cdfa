"""Draws of made surfaces: sums of their slopes and areas over batches, until the errors are small."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import MetafemError
from metafem.models import Model
from metafem.prediction import Tolerances
from metafem.studies.sampling.moments import Sums, added, moments, sums_of
from metafem.studies.sampling.points import FEWEST_BATCHES, MOST_DRAWS, unit_points
from metafem.studies.sampling.schedulers import Run
from metafem.studies.sampling.slope import Slope
from metafem.surface import Surface

# Points of a batch if the number of draws follows from the wanted error: 16 batches are then few draws.
ROUND_POINTS = 16

# Number of batches added before the errors are computed again.
ROUND_BATCHES = 8


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
