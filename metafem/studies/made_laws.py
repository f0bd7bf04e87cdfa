"""Random laws of made surfaces in batches, and their misfits from the target of a design."""

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
from metafem.studies.sampling.batches import Run
from metafem.studies.sampling.inputs import Inputs
from metafem.studies.sampling.moments import Sums, added, sums_of
from metafem.studies.sampling.points import MOST_DRAWS, unit_points
from metafem.studies.sampling.slope import Slope
from metafem.surface import Surface


@dataclass(frozen=True, eq=False)
class MadeLaws:
    """Batches of random made surfaces with given tolerances, and with errors of the parameters.

    A made surface has the friction F' = sigma' B' A0(P/E*') at a load P. Its law is rescaled with the nominal
    values E*, sigma and B, and then compared with the target. An error of E* therefore changes the argument
    of A0, and errors of sigma and B change the factor of A0.

    The points of the unit cube depend only on the seed and the batch, so all tolerances with the same
    number of random coordinates use the same points (common random numbers). The first columns of the points
    belong to the tolerances.
    """

    surface: Surface
    model: Model
    tolerances: Tolerances
    inputs: Inputs
    law: TargetLaw
    branches: tuple[Branch, ...]
    slope: Slope | None
    seed: int
    size: int
    draws: int  # the last batch may be smaller
    described: bool = True  # whether slopes and areas are computed in addition to the misfits

    @property
    def batches(self) -> range:
        """Indices of the batches."""
        return range(-(-self.draws // self.size))

    @property
    def shown(self) -> FloatArray:
        """Rescaled loads of the reported areas [mm^2]: the loads of the slope, or else of the target."""
        return self.law.load if self.slope is None else self.slope.load

    @cached_property
    def load(self) -> FloatArray:
        """All rescaled loads at which laws are computed, increasing, (k,) [mm^2]."""
        lists = [self.law.load, *(branch.load for branch in self.branches)]
        return np.unique(np.concatenate([*lists, self.shown] if self.described else lists))

    @cached_property
    def nominal(self) -> tuple[float, FloatArray]:
        """The misfit [-], and the slope and the areas (q,), without errors."""
        area = self.model.areas(self.surface, self.load, self.surface.height[None])
        if not np.isfinite(area).all():
            raise NotConverged("the model has no solution for the surface of the design")
        return float(self._misfits(area)[0]), self._quantities(area)[0]

    def __call__(self, batch: int) -> dict[str, np.ndarray]:
        """Return the misfits (m,) of a batch, infinite without a solution, and the sums of its quantities."""
        size = min(self.size, self.draws - batch * self.size)
        dimensions = self.tolerances.dimensions(self.surface)
        unit = unit_points(self.seed, batch, size, dimensions + len(self.inputs.names), plain=True)
        area = self._areas(unit[:, :dimensions], self.inputs.errors(unit[:, dimensions:]))
        result = {"misfit": self._misfits(area)}
        if self.described:
            difference = self._quantities(area) / self.nominal[1] - 1.0
            result |= sums_of(difference, np.zeros_like(difference))
        return result

    def _areas(self, unit: FloatArray, errors: dict[str, FloatArray]) -> FloatArray:
        """Return F'/(sigma B) [mm^2] of made surfaces at P/E* = load, (m, k); E*, sigma and B are nominal."""
        surface, load = self.surface, self.load
        height, radius, position = self.tolerances.perturbed(surface, unit)
        material, factor = surface.material, np.ones((len(unit), 1))
        for name in ("shear_strength", "area_ratio"):
            if name in errors:
                factor = factor * (1.0 + errors[name] / getattr(surface.friction, name))
        if "radius" in errors:
            scale = 1.0 + errors["radius"] / surface.radius.mean()
            radius = scale * (surface.radius if radius is None else radius)
        if "composite_modulus" not in errors:
            return factor * self.model.areas(surface, load, height, radius, position)
        varies = contact_of(self.model).scales_with_stress
        parts = []
        for row, times in enumerate(1.0 + errors["composite_modulus"][:, 0] / material.composite_modulus):
            radii, places = (None if each is None else each[row : row + 1] for each in (radius, position))
            # the effect of the contact law's energy or stress depends on the modulus of the draw
            other = replace(material, composite_modulus=times * material.composite_modulus)
            drawn = surface.replaced(material=other) if varies else surface
            parts.append(self.model.areas(drawn, load / times, height[row : row + 1], radii, places))
        return factor * np.concatenate(parts)

    def _misfits(self, area: FloatArray) -> FloatArray:
        """Return the misfits (m,) of laws (m, k) at all loads; infinite for a law without a solution."""
        solved = np.isfinite(area).all(axis=1)
        found = area[solved]
        slopes = np.empty((len(found), len(self.branches)))
        for column, branch in enumerate(self.branches):
            off = branch.load - branch.load.mean()
            # no matrix product: its last bits would depend on the number of threads
            slopes[:, column] = np.einsum("mk,k->m", self._at(branch.load, found), off / (off @ off))
        result = np.full(len(area), np.inf)
        if len(found):
            at_target = self._at(self.law.load, found)
            difference = at_target / self.law.laws(at_target) - 1.0
            result[solved] = misfits(self.law, self.branches, difference, slopes)
        return result

    def _quantities(self, area: FloatArray) -> FloatArray:
        """Return the slope (1 if there is none) and the areas at the loads `shown`, (m, q)."""
        shown = self._at(self.shown, area)
        slope = np.ones(len(area)) if self.slope is None else np.einsum("mk,k->m", shown, self.slope.weight)
        return np.column_stack([slope, shown])

    def _at(self, load: FloatArray, area: FloatArray) -> FloatArray:
        """Return the areas (m, l) at the loads (l,), from the areas (m, k) at all loads."""
        return area[:, np.searchsorted(self.load, load)]


def share_error(share: float, count: int) -> float:
    """Return the standard error of a share of draws: half the width of Wilson's interval, never 0."""
    return math.sqrt(share * (1.0 - share) / count + 0.25 / count**2) / (1.0 + 1.0 / count)


def described(compute: Run, task: MadeLaws, allowed: float, error: float | None) -> tuple[FloatArray, Sums]:
    """Return the misfits of all draws (m,), and the sums of their slopes and areas.

    If `error` is given, the number of draws is doubled until the share of draws with a misfit of at most
    `allowed` has this error.
    """
    parts: list[FloatArray] = []
    total: Sums = {}
    while True:
        for batch in compute(task, task.batches[len(parts) :]):
            parts.append(batch.pop("misfit"))
            total = added(total, batch)
        drawn = np.concatenate(parts)
        enough = error is None or share_error(float((drawn <= allowed).mean()), len(drawn)) <= error
        if enough or 2 * task.draws > MOST_DRAWS:
            return drawn, total
        task = replace(task, draws=2 * task.draws)
