"""Laws of a tilted surface, and mean and deviation of the slope for a uniform angle around zero."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.errors import NotConverged
from metafem.models import Model
from metafem.studies.largest_tolerances import ALLOWED
from metafem.studies.sampling.moments import Estimate
from metafem.studies.sampling.schedulers import Run
from metafem.studies.sampling.slope import Slope
from metafem.surface import STEEPEST, Surface

# Steps up to an angle in the search for the largest one. The search ends if the angle is among the last three
# quarters of the steps, where its error is below 1e-3. Largest number of searches: the next one has steps
# 1/200 as large, or goes up to twice the angle.
SEARCH_STEPS, SEARCHES = 400, 12

# Shuffled placements of one batch: 2,001 angles and 20 loads of 64 independent asperities take a quarter of a
# second. A batch of coupled asperities, which take a hundred times as long, is a single one.
AT_ONCE = 10

# Heights that are solved at once: 32 MiB.
MOST_HEIGHTS = 2**22

# Number of neighbouring angles on each side that are included in the error.
NEIGHBOURS = 2


@dataclass(frozen=True, eq=False)
class Tilts:
    """Laws of a surface at all angles, as made (batch 0) and for shuffled placements (further batches)."""

    surface: Surface
    model: Model
    direction: FloatArray  # (2,), slopes along x and along y over the tangent of the angle
    angle: FloatArray  # (a,) [rad]
    fit: Slope
    shuffles: int
    seed: int

    @property
    def tilt(self) -> FloatArray:
        """Slopes along x and along y [-], (a, 2)."""
        return np.outer(np.tan(self.angle), self.direction)

    @property
    def at_once(self) -> int:
        """Number of shuffled placements of a batch."""
        return 1 if self.model.couples else AT_ONCE

    @property
    def batches(self) -> int:
        """Number of batches."""
        return 1 + -(-self.shuffles // self.at_once)

    def __call__(self, batch: int) -> dict[str, FloatArray]:
        """Return the slopes (p, a) of the placements of a batch, and the areas of batch 0, (1, a, k)."""
        orders = [np.arange(self.surface.count)]
        if batch > 0:
            placements = range(self.at_once * (batch - 1), min(self.at_once * batch, self.shuffles))
            seeds = [np.random.SeedSequence(self.seed, spawn_key=(k,)) for k in placements]
            orders = [np.random.default_rng(seed).permutation(self.surface.count) for seed in seeds]
        found = [self._law(order) for order in orders]
        areas = np.array([area for area, _ in found])
        return {
            # no product of matrices: its last bits depend on the number of threads
            "slope": np.einsum("pak,k->pa", areas, self.fit.weight),
            "area": areas if batch == 0 else areas[:0],
            "failed": np.array([failed for _, failed in found]),
        }

    def _law(self, order: IntArray) -> tuple[FloatArray, int]:
        """Return A0 (a, k), interpolated where there is no solution, and the number of interpolated laws."""
        area = self._areas(order)
        solved = np.isfinite(area).all(axis=1)
        if solved.sum() < 2:
            raise NotConverged("fewer than two angles of a placement have a solution")
        if not solved.all():
            for column in area.T:
                column[~solved] = np.interp(self.angle[~solved], self.angle[solved], column[solved])
        return area, int((~solved).sum())

    def _areas(self, order: IntArray) -> FloatArray:
        surface = self.surface
        rise = self.tilt @ surface.position.T
        radius = None if np.ptp(surface.radius) == 0.0 else surface.radius[order]
        rows = max(1, MOST_HEIGHTS // surface.count)
        parts = []
        for start in range(0, len(rise), rows):
            height = surface.height[order] + rise[start : start + rows]
            radii = None if radius is None else np.broadcast_to(radius, height.shape)
            parts.append(self.model.areas(surface, self.fit.load, height, radii))
        return np.concatenate(parts)


def both_signs(angle: FloatArray) -> FloatArray:
    """Return increasing angles with both signs and 0, (2 k + 1,)."""
    return np.concatenate([-angle[::-1], [0.0], angle])


def largest_angle(compute: Run, task: Tilts) -> Estimate:
    """Return the smallest angle at which the slope as made scatters by `ALLOWED`, and its error [rad]."""
    surface = task.surface
    width = float(np.ptp(surface.position @ task.direction))
    end = min(STEEPEST, math.atan2(float(surface.radius.mean()), width))
    for _ in range(SEARCHES):
        angle = end * np.arange(1, SEARCH_STEPS + 1) / SEARCH_STEPS
        trial = replace(task, angle=both_signs(angle), shuffles=0)
        (slope,) = next(iter(compute(trial, [0])))["slope"]
        scatter = Estimate(*(each / slope[SEARCH_STEPS] for each in within(trial.angle, slope)[1]))
        beyond = np.flatnonzero(scatter.value > ALLOWED)
        if not beyond.size:
            if end == STEEPEST:
                return Estimate(math.inf, 0.0)
            end = min(2.0 * end, STEEPEST)
            continue
        i = int(beyond[0])
        if 4 * i >= SEARCH_STEPS:
            rate = float(scatter.value[i] - scatter.value[i - 1]) / float(angle[0])
            over = float(scatter.value[i]) - ALLOWED
            return Estimate(float(angle[i]) - over / rate, float(scatter.error[i]) / rate)
        end = 2.0 * float(angle[i])
    return Estimate(math.nan, 0.0)


def within(angle: FloatArray, value: FloatArray) -> tuple[Estimate, Estimate]:
    """Return mean and standard deviation over [-angle, angle], each with its error, (..., k).

    angle: (2 k + 1,), increasing, from minus the largest to the largest, with 0. value: (..., 2 k + 1).
    The error is the change with every second angle, counted from each end.
    """
    middle = len(angle) // 2
    fine = _uniform(angle, value)
    coarse = tuple(np.empty_like(part) for part in fine)
    for odd in (0, 1):
        # every second angle, with 0 (odd = 0) or without
        some = slice((middle - odd) % 2, None, 2)
        for whole, part in zip(coarse, _uniform(angle[some], value[..., some]), strict=True):
            whole[..., 1 - odd :: 2] = part
    mean, sd = (
        Estimate(one, _largest_nearby(np.abs(one - other))) for one, other in zip(fine, coarse, strict=True)
    )
    return mean, sd


def _largest_nearby(change: FloatArray) -> FloatArray:
    """Return the largest value at an angle and its neighbours: a change may be zero at a single angle."""
    padded = np.pad(change, [(0, 0)] * (change.ndim - 1) + [(NEIGHBOURS, NEIGHBOURS)], mode="edge")
    nearby = np.lib.stride_tricks.sliding_window_view(padded, 2 * NEIGHBOURS + 1, axis=-1)
    return np.asarray(nearby.max(axis=-1))


def _uniform(angle: FloatArray, value: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return mean and standard deviation over [-angle, angle] of values that are linear between angles."""
    centre = value[..., [len(angle) // 2]]  # preserves the digits of small deviations
    left, right = value[..., :-1] - centre, value[..., 1:] - centre
    width = np.diff(angle)
    count = len(angle) // 2
    moments = []
    for integral in (width * (left + right) / 2.0, width * (left**2 + left * right + right**2) / 3.0):
        both = (integral + integral[..., ::-1])[..., -count:]
        if len(width) % 2:
            both[..., 0] /= 2.0  # the interval across 0 is symmetric
        moments.append(np.cumsum(both, axis=-1) / (2.0 * angle[-count:]))
    mean, square = moments
    return mean + centre, np.sqrt(np.maximum(square - mean**2, 0.0))
