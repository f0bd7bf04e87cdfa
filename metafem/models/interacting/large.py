"""Curves of scenes that are too large for dense matrices."""

from __future__ import annotations

import math
from collections.abc import Hashable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from metafem._kernels.contact.tabulated import Law
from metafem._kernels.curve import (
    REMEMBERED,
    Results,
    empty_memory,
    predict,
    remember,
    uniform_approach,
)
from metafem._kernels.equations import State, spread
from metafem._kernels.vectors import exact_sum
from metafem._validate import FloatArray
from metafem.models.interacting.coarse import coarsen
from metafem.models.interacting.influence import MOST_KEPT_SUMS, Sites
from metafem.models.interacting.newton_krylov import TOLERANCE, ContactEquations, Iterate, open_state
from metafem.models.interacting.sums.fast_sums import fast_sums
from metafem.progress import each
from metafem.substrate import Radial
from metafem.surface import Surface

# Residual of the coarse model at which a start is good enough.
START = 0.01

# Empty array that is passed for results that are not recorded.
NOT_RECORDED = np.empty((0, 0))


def large_scene(surface: Surface, substrate: Radial, order: int) -> LargeScene:
    """Return the fast sums and the coarse model for the sites of a surface; the last ones are cached."""
    if surface.count > MOST_KEPT_SUMS or not isinstance(substrate, Hashable):
        return LargeScene(surface, substrate, order)
    return _last(Sites.of(surface), substrate, order)


@lru_cache(maxsize=1)
def _last(sites: Sites, substrate: Radial, order: int) -> LargeScene:
    """Return the cached sums of the last scene."""
    return LargeScene(sites.surface, substrate, order)


class LargeScene:
    """Fast sums and a coarse model for the sites of one surface; they do not depend on the heights."""

    def __init__(self, surface: Surface, substrate: Radial, order: int) -> None:
        self.order, self.substrate = order, substrate
        self.sums = fast_sums(surface, substrate, order)
        self.coarse = coarsen(surface.position, substrate)

    def equations(self, law: Law, self_term: FloatArray, gap: FloatArray) -> ContactEquations:
        """Return the equations of the contacts; self_term (n,) [1/mm] is added to that of the substrate."""
        own = self_term + self.sums.self_influence
        return ContactEquations(self.sums, self.order, law, own, np.ascontiguousarray(gap), self.coarse)

    def follow(
        self,
        law: Law,
        self_term: FloatArray,
        gap: FloatArray,
        control: FloatArray,
        by_load: bool,
        results: Results,
        indentation: FloatArray = NOT_RECORDED,
    ) -> State:
        """Fill the results (k,) at increasing loads or approaches, and return the last state.

        indentation: (k, n) [mm]; filled with nominal indentations unless empty.
        """
        equations = self.equations(law, self_term, gap)
        sums: Any = self.coarse  # order 1 needs only its displacements
        coarse = replace(equations, sums=sums, order=1)
        gap = equations.gap
        x = 0.0
        memory, points, coupled = empty_memory(len(gap)), 0, np.zeros_like(gap)
        state = open_state(-gap)
        for j, value in enumerate(each("load", control.tolist())):
            results.approach[j] = 0.0 if by_load else value
            if value <= 0.0:
                state = open_state(min(float(results.approach[j]), 0.0) - gap)
            else:
                target = float(value) if by_load else 0.0
                if points:
                    stiffness = results.stiffness[j - 1]
                    ahead = (target - results.load[j - 1]) / stiffness if by_load else value - x
                    z = np.empty_like(gap)
                    start = predict(memory, points, x + float(ahead), target, law, z)
                    state, new = equations.newton(z, start, target)
                if not points or state.residual > TOLERANCE:
                    start = float(uniform_approach(gap, law, target) if by_load else value)
                    first, start = coarse.newton(start - gap, start, target, START)
                    state, new = equations.newton(first.state.z, start, target)
                largest = float(state.state.indentation.max())
                state.residual = max(state.residual, self.sums.error(state.state.load) / largest)
                further, x = new > x, new
                spread(self.order, law, state.state)
                self._record(results, j, x, state)
                if state.residual <= TOLERANCE:
                    points = min(REMEMBERED, points + 1) if further else 1
                    remember(memory, x, state.state.z)
                    results.stiffness[j], _, coupled = equations.tangent(state, coupled)
                else:
                    points = 0
            if indentation.size:
                indentation[j] = state.state.z
        return state.state

    def area_gradients(
        self,
        law: Law,
        self_term: FloatArray,
        gap: FloatArray,
        indentation: FloatArray,
    ) -> FloatArray:
        """Return dA0/dh at fixed load [mm], (k, n), for equilibria with nominal indentations z (k, n)."""
        equations = self.equations(law, self_term, gap)
        states = (equations.respond(z, 0.0, 0.0) for z in indentation)  # neither approach nor load matters
        none = np.zeros_like(gap)
        return np.array([equations.area_gradient(at) if at.closed.any() else none for at in states])

    @staticmethod
    def _record(results: Results, j: int, approach: float, state: Iterate) -> None:
        results.approach[j] = approach
        results.load[j] = exact_sum(state.state.load)
        results.area[j] = math.pi * exact_sum(state.state.footprint)
        results.radius[j] = math.sqrt(float(state.state.square.max()))
        results.residual[j] = state.residual
        results.steps[j] = state.steps
