"""Draws of made surfaces: sums of their slopes and areas over batches, until the errors are small."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import MetafemError
from metafem.models import Model
from metafem.prediction import Tolerances
from metafem.studies.sampling.moments import Sums, moments
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
    """The batches of a study of one surface at levels (l,) of its tolerances.

    All levels use the same points (common random numbers). The quantities (q,) are the slope and the areas
    at its loads, each over its nominal value.
    """

    surface: Surface
    model: Model
    slope: Slope
    tolerances: tuple[Tolerances, ...]
    nominal: FloatArray  # (q,)
    response: FloatArray  # (q, n), derivatives of the quantities by the heights, over the nominal values
    seed: int
    size: int
    draws: int  # the last batch of plain draws may be smaller
    plain: bool
    active: tuple[bool, ...]  # levels with draws
    first: int = 0  # number of the first batch

    def at(self, tolerances: Tolerances, first: int) -> SlopeDraws:
        """Return the batches of the same points at another level, with their own numbers."""
        return replace(self, tolerances=(tolerances,), active=(True,), first=first)

    @cached_property
    def scale(self) -> FloatArray:
        """Standard deviations of the linear responses, (l, q)."""
        found = [each.linear_covariance(self.surface, self.response) for each in self.tolerances]
        return np.array([np.sqrt(np.diag(each)) for each in found])

    def __call__(self, batch: int) -> dict[str, np.ndarray]:
        """Return the sums of one batch, stacked over the levels."""
        local = batch - self.first
        size = min(self.size, self.draws - local * self.size) if self.plain else self.size
        dimensions = [each.dimensions(self.surface) for each in self.tolerances]
        points = unit_points(self.seed, local, size, max(dimensions), plain=self.plain)
        levels = []
        for level, tolerances in enumerate(self.tolerances):
            # heights come first and are left out if they have no errors
            unit = points[:, points.shape[1] - dimensions[level] :]
            difference, response = np.zeros((2, size if self.active[level] else 0, len(self.nominal)))
            if self.active[level] and dimensions[level] > 0:
                height, radius, position = tolerances.perturbed(self.surface, unit)
                areas = self.model.areas(self.surface, self.slope.load, height, radius, position)
                # no products of matrices: their last bits depend on the number of threads
                slopes = np.einsum("mk,k->m", areas, self.slope.weight)
                difference = np.column_stack([slopes, areas]) / self.nominal - 1.0
                response = np.einsum("mn,qn->mq", height - self.surface.height, self.response)
                response /= np.where(self.scale[level] > 0.0, self.scale[level], 1.0)
            levels.append(Sums.of(difference, response))
        return {name: np.array([sums[name] for sums in levels]) for name in levels[0]}


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


def summed(compute: Run, task: SlopeDraws, error: float | None = None) -> tuple[Sums, int]:
    """Return the sums over all batches, and the number after the last one.

    With `error` batches are added in fixed rounds, at the levels whose slope's standard deviation has a
    larger relative error.
    """
    total, begin = None, task.first
    first, last = 0, -(-task.draws // task.size) if error is None else FEWEST_BATCHES
    while True:
        for batch in compute(task, range(begin + first, begin + last)):
            sums = Sums.of_batch(batch)
            total = sums if total is None else total.plus(sums)
        assert total is not None
        if error is None:
            return total, begin + last
        found = moments(total).sd
        wanting = found.error[:, 0] > error * found.value[:, 0]
        if not wanting.any() or last * task.size >= MOST_DRAWS:
            return total, begin + last
        task = replace(task, active=tuple(wanting.tolist()))
        first, last = last, last + ROUND_BATCHES
