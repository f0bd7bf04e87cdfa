"""Heights on all sites of a template as unknowns of a search, of which some have no asperity."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.errors import InvalidInput
from metafem.inversion.candidate import Candidate
from metafem.inversion.problem import Problem
from metafem.inversion.search.asperities import beyond
from metafem.inversion.search.spaces import Bounded, LateResidual, Residual
from metafem.inversion.search.target_law import TargetLaw
from metafem.models import Model, Sensitivity
from metafem.models.model import Sensitive
from metafem.surface import Surface


@dataclass(frozen=True, eq=False)
class OnSites:
    """The heights of a candidate on all sites of a problem, with those of absent asperities below the foot.

    A random change may add asperities; they have the radius and the cap of the lowest summit.
    """

    template: Surface
    space: Bounded
    whole: Candidate

    @classmethod
    def of(cls, problem: Problem, start: Candidate) -> OnSites:
        """Return the sites of a problem with the heights of a candidate; prescribed heights are fixed."""
        limits, pins = problem.limits, problem.pins
        space = Bounded(limits.foot, limits.top, pins.rows, pins.heights)
        height, rows = np.full(problem.count, space.absent), np.full(problem.count, start.height.argmin())
        height[start.sites], rows[start.sites] = start.height, np.arange(len(start.height))
        whole = replace(start.taken(rows), sites=np.arange(problem.count), height=height)
        return cls(problem.template, space, whole)

    def candidate(self, height: FloatArray) -> Candidate:
        """Return the candidate with heights on all sites (n,) [mm], without the absent asperities."""
        some = np.flatnonzero(self.space.exists(height))
        return replace(self.whole.taken(some), sites=some).with_heights(height[some])

    def sensitivity(
        self, model: Sensitive, load: FloatArray, height: FloatArray
    ) -> tuple[Sensitivity, IntArray]:
        """Return the sensitivity of heights on all sites (n,) [mm], and the sites of its columns.

        Absent asperities are far below the plane, so that the influences of all sites are computed only once.
        If the model uses the positions of open asperities, they are left out.
        """
        some = np.arange(len(height))
        if not getattr(model, "ignores_open", True):
            some = np.flatnonzero(self.space.exists(height))
        surface = self._surface if len(some) == len(height) else self._surface.only(some)
        return model.sensitivity(surface, load, height[some]), some

    def residual(self, model: Sensitive, law: TargetLaw) -> Residual:
        """Return the differences of the law under a model from a target, as a function of the heights."""

        def residual(height: FloatArray) -> LateResidual:
            try:
                found, some = self.sensitivity(model, law.load, height)
            except InvalidInput:  # beyond the range of the contact law
                return beyond(law.load, height)

            def gradient() -> FloatArray:
                rates = np.zeros((len(law.load), len(height)))
                rates[:, some] = found.gradient
                return rates

            return law.late_residual(found.curve.area, gradient)

        return residual

    def residual_of_model(self, model: Model, law: TargetLaw) -> Residual:
        """Return the residual of a model without sensitivities, with those of its `gradient_model`."""
        near = self.residual(model.gradient_model, law)

        def residual(height: FloatArray) -> LateResidual:
            some = np.flatnonzero(self.space.exists(height))
            surface = self._surface.only(some, height=height[some])
            area = model.curve(surface, law.load).area
            return law.late_residual(area, lambda: near(height)[1]())

        return residual

    @cached_property
    def _surface(self) -> Surface:
        return self.whole.surface(self.template)
