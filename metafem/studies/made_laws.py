"""Laws of made surfaces, drawn in batches, and their misfits from the target of a design."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from metafem._validate import FloatArray
from metafem.errors import NotConverged
from metafem.inversion.assessment import misfits
from metafem.inversion.candidate import Branch
from metafem.inversion.search.target_law import TargetLaw
from metafem.models import Model
from metafem.models.model import contact_of
from metafem.prediction import Tolerances
from metafem.studies.sampling.inputs import Inputs
from metafem.studies.sampling.moments import Sums
from metafem.studies.sampling.points import MOST_DRAWS, unit_points
from metafem.studies.sampling.schedulers import Run
from metafem.studies.sampling.slope import Slope
from metafem.surface import Surface


@dataclass(frozen=True, eq=False)
class MadeLaws:
    """The batches of made surfaces under given tolerances, with errors of the parameters.

    A made surface has the friction F' = sigma' B' A0(P/E*') at a load P. It is compared with the target at
    P/E* and F'/(sigma B), with the nominal values, so an error of E* changes the rescaled load and errors of
    sigma and B the rescaled friction.

    The points of the unit cube depend only on the seed and the batch: they are the same for other tolerances
    of the same dimensions (common random numbers). Columns of the tolerances come first.
    """

    surface: Surface
    model: Model
    tolerances: Tolerances
    inputs: Inputs | None
    law: TargetLaw
    branches: tuple[Branch, ...]
    slope: Slope | None
    seed: int
    size: int
    draws: int  # the last batch may be smaller
    first: int = 0  # number of the first batch
    described: bool = True  # whether slopes and areas are also computed

    @property
    def batches(self) -> range:
        """Numbers of the batches."""
        return range(self.first, self.first + -(-self.draws // self.size))

    @property
    def shown(self) -> FloatArray:
        """Loads of the described areas [mm^2]: those of the slope, otherwise those of the target."""
        return self.law.load if self.slope is None else self.slope.load

    @cached_property
    def nominal(self) -> tuple[float, FloatArray]:
        """The misfit [-], and the slope and the areas (q,), without errors."""
        nowhere = np.empty((1, 0))
        area = self._areas(Tolerances(), nowhere, None, self._loads(True))
        if not np.isfinite(area).all():
            raise NotConverged("the model has no solution for the surface of the design")
        return float(self._misfits(area)[0]), self._quantities(area)[0]

    def __call__(self, batch: int) -> dict[str, np.ndarray]:
        """Return the misfits (m,) of a batch, infinite without a solution, and the sums of its quantities."""
        local = batch - self.first
        size = min(self.size, self.draws - local * self.size)
        dimensions = self.tolerances.dimensions(self.surface)
        more = 0 if self.inputs is None else len(self.inputs.names)
        unit = unit_points(self.seed, local, size, dimensions + more, plain=True)
        errors = None if self.inputs is None else self.inputs.errors(unit[:, dimensions:])
        area = self._areas(self.tolerances, unit[:, :dimensions], errors, self._loads(self.described))
        result = {"misfit": self._misfits(area)}
        if self.described:
            quantities = self._quantities(area)
            difference = quantities / self.nominal[1] - 1.0
            sums = Sums.of(difference, np.zeros_like(difference))
            result |= {name: np.asarray(value)[None] for name, value in sums.items()}
        return result

    def _loads(self, described: bool) -> FloatArray:
        """Return all required loads, increasing, (k,)."""
        lists = [self.law.load, *(branch.load for branch in self.branches)]
        return np.unique(np.concatenate([*lists, self.shown] if described else lists))

    def _areas(
        self,
        tolerances: Tolerances,
        unit: FloatArray,
        errors: dict[str, FloatArray] | None,
        load: FloatArray,
    ) -> FloatArray:
        """Return F'/(sigma B) of made surfaces at P/E* = load, with the nominal values, (m, k)."""
        surface = self.surface
        height, radius, position = tolerances.perturbed(surface, unit)
        if errors is None:
            return self.model.areas(surface, load, height, radius, position)
        material, friction = surface.material, surface.friction
        factor = np.ones((len(unit), 1))
        if friction is not None:
            for name in ("shear_strength", "area_ratio"):
                factor = factor * (1.0 + errors.get(name, 0.0) / getattr(friction, name))
        if "radius" in errors:
            scale = 1.0 + errors["radius"] / surface.radius.mean()
            radius = scale * (surface.radius if radius is None else radius)
        if "composite_modulus" not in errors:
            return factor * self.model.areas(surface, load, height, radius, position)
        stiffer = 1.0 + errors["composite_modulus"][:, 0] / material.composite_modulus
        varies = contact_of(self.model).scales_with_stress
        parts = []
        for row, times in enumerate(stiffer):
            radii = None if radius is None else radius[row : row + 1]
            places = None if position is None else position[row : row + 1]
            # the effect of an energy or stress of a law depends on the modulus of each draw
            other = replace(material, composite_modulus=times * material.composite_modulus)
            drawn = surface.replaced(material=other) if varies else surface
            parts.append(self.model.areas(drawn, load / times, height[row : row + 1], radii, places))
        return factor * np.concatenate(parts)

    def _misfits(self, area: FloatArray) -> FloatArray:
        """Return the misfits (m,) of laws at all loads (m, k); infinite where there is no solution."""
        load = self._loads(area.shape[1] != len(self._loads(False)))
        solved = np.isfinite(area).all(axis=1)
        found = area[solved]
        slopes = np.empty((len(found), len(self.branches)))
        for column, branch in enumerate(self.branches):
            rows, off = np.searchsorted(load, branch.load), branch.load - branch.load.mean()
            # no products of matrices: their last bits depend on the number of threads
            slopes[:, column] = np.einsum("mk,k->m", found[:, rows], off / (off @ off))
        result = np.full(len(area), np.inf)
        if len(found):
            at_target = found[:, np.searchsorted(load, self.law.load)]
            difference = at_target / self.law.laws(at_target) - 1.0
            result[solved] = misfits(self.law, self.branches, difference, slopes)
        return result

    def _quantities(self, area: FloatArray) -> FloatArray:
        """Return the slope, 1 without one, and the areas at the described loads, (m, q)."""
        shown = area[:, np.searchsorted(self._loads(True), self.shown)]
        if self.slope is None:
            return np.column_stack([np.ones(len(area)), shown])
        return np.column_stack([np.einsum("mk,k->m", shown, self.slope.weight), shown])


def share_error(share: float, count: int) -> float:
    """Return the standard error of a share of draws: half of Wilson's interval, which is never empty."""
    return math.sqrt(share * (1.0 - share) / count + 0.25 / count**2) / (1.0 + 1.0 / count)


@dataclass(eq=False)
class Runs:
    """Batches of several tasks, one after another, each with its own number."""

    compute: Run
    next_number: int = 0

    def misfits(self, task: MadeLaws) -> FloatArray:
        """Return the misfits of all draws of a task, (m,)."""
        task = replace(task, first=self.next_number, described=False)
        self.next_number = task.batches.stop
        return np.concatenate([batch["misfit"] for batch in self.compute(task, task.batches)])

    def described(self, task: MadeLaws, allowed: float, error: float | None) -> tuple[FloatArray, Sums]:
        """Return the misfits of all draws (m,), and the sums of their slopes and areas.

        With `error` the number of draws is doubled until the probability has this error.
        """
        parts: list[FloatArray] = []
        total, done = None, 0
        while True:
            for batch in self.compute(task, task.batches[done:]):
                parts.append(batch.pop("misfit"))
                sums = Sums.of_batch(batch)
                total = sums if total is None else total.plus(sums)
            done = self.next_number = len(task.batches)
            drawn = np.concatenate(parts)
            assert total is not None
            enough = error is None or share_error(float((drawn <= allowed).mean()), len(drawn)) <= error
            if enough or 2 * task.draws > MOST_DRAWS:
                return drawn, total
            task = replace(task, draws=2 * task.draws)
