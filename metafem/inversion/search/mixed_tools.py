"""Search for independent asperities made by several tools whose law is nearest to a target."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray, IntArray
from metafem.caps import Cap, Caps, Power
from metafem.inversion.search.asperities import Asperities, OfExponents, OfTools
from metafem.inversion.search.dictionary import starts
from metafem.inversion.search.levenberg_marquardt import NEAR, Minimum, descend, search
from metafem.inversion.search.nearest_law import GOAL
from metafem.inversion.search.spaces import Heights, LateResidual, Residual
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.tools.kit import Kit

if TYPE_CHECKING:
    from metafem.inversion.problem import Problem

# Up to this number of asperities, random initial guesses come first, and their number.
FEW, RANDOM_STARTS = 12, 40

# Number of results of descents that are changed at random, over the number of descents.
BEST = 0.25

# Misfit over the goal up to which fewer tools are preferred.
FEWER = 2.0

# Part of the exponents that move to their steps at once, if fewer exponents do not meet the target.
AT_ONCE = 8

# Numbers of exponents to which those of a range are reduced, if the target is still met.
NUMBERS = (2, 3, 4, 5, 6, 8, 10, 12, 16)

# Number of restarts with fixed tools, if the search has as many, and number of steps in which exponents are
# divided into groups. Exponents move to their steps one by one only in a search with as many restarts.
FIXED_RESTARTS, GROUPING_STEPS = 6, 20


@dataclass(frozen=True, eq=False)
class ToolSearch:
    """Search for the independent asperities, made by the tools of a kit, whose law is nearest to a target.

    The laws of the initial guesses are near the frictions `guesses`, (k,) [mm^2] each. The search ends at a
    misfit of `goal`. If the law must be exact, a descent of the heights to the misfit `exact` follows.
    """

    problem: Problem
    kit: Kit
    law: TargetLaw
    guesses: list[FloatArray]
    restarts: int
    rng: np.random.Generator
    goal: float = GOAL
    exact: float | None = None

    def nearest(self) -> tuple[float, FloatArray, FloatArray, Cap]:
        """Return the misfit, and heights, with the tallest first and equal to 0, radii and caps (n,)."""
        best = self._fewest(*self.space.split(self._mixed().unknowns))
        height, shape = best.unknowns, best.shape
        if self.exact is not None:
            given = self.exact, min(FIXED_RESTARTS, self.restarts), self.rng, self.problem.options, True
            found = search(self._of_heights(shape), [height], self._heights, *given)
            height, best = found.unknowns, Mixture(found.unknowns, found.misfit, shape)
        order = np.argsort(-height, kind="stable")
        return best.misfit, height[order] - height.max(), *self._made(shape[order])

    @property
    def _heights(self) -> Heights:
        return Heights(self.problem.limits.span)

    @cached_property
    def space(self) -> Asperities:
        """Unknowns of the search."""
        span, count = self.problem.limits.span, self.problem.count
        if self.kit.range is None:
            return OfTools(span, count, summits=self.problem.tool_summits)
        radius = float(self.kit.radii[0])
        return OfExponents(span, count, range=self.kit.range, radius=radius, depth=self._depth)

    @cached_property
    def _depth(self) -> float:
        """Indentation [mm] of one of N equal asperities of the middle tool at the last load."""
        model, tools = self.problem.independent, self.problem.tool_summits
        load = self.law.load[-1:] / max(1.0, 0.5 * self.problem.count)
        middle = tools[len(tools) // 2 : len(tools) // 2 + 1]
        return float(model.curve_of(np.zeros(1), middle, load).approach[0])

    @cached_property
    def residual(self) -> Residual:
        """Residual of independent asperities as a function of the unknowns."""
        return self.space.residual(self.problem.independent, self.law)

    def _of_heights(self, shape: FloatArray) -> Residual:
        """Return the residual as a function of the heights of asperities with given shapes (n,)."""

        def residual(height: FloatArray) -> LateResidual:
            r, jacobian = self.residual(self.space.joined(height, shape))
            return r, lambda: jacobian()[:, : len(height)]

        return residual

    def _mixed(self) -> Minimum:
        """Return the best heights and shapes."""
        found: list[Minimum] = []
        options = self.problem.options
        for start in self._starts():
            found.append(
                descend(self.residual, self.space.project(start), self.space, self.goal, options=options)
            )
            if found[-1].misfit <= NEAR * self.goal:
                break
        found.sort(key=lambda each: each.misfit)
        best = found[0]
        for one in found[: max(1, round(BEST * self.problem.effort.mixtures))]:
            given = self.goal, self.restarts, self.rng, options
            changed = search(self.residual, [one.unknowns], self.space, *given)
            best = changed if changed.misfit < best.misfit else best
            if best.misfit <= self.goal:
                break
        return best

    def _starts(self) -> Iterator[FloatArray]:
        """Yield initial unknowns: random ones for few asperities, then those nearest to the target."""
        count, span = self.problem.count, self.problem.limits.span
        deep = min(4.0 * self._depth, span)
        if count <= FEW:
            for number in self.rng.integers((count + 1) // 2, count + 1, size=RANDOM_STARTS).tolist():
                height = -self.rng.uniform(0.0, deep, number)
                yield self._joined(height, self.rng.integers(len(self.kit.tools), size=number))
        law, tools = self.problem.contact, self.problem.tool_summits
        most = self.problem.effort.mixtures
        near = [
            self._joined(start.height, start.which)
            for friction in self.guesses[:most]
            for start in starts(law, tools, self.law.load, friction, span, count)
        ]
        yield from sorted(near, key=self._misfit)[:most]
        if not near:
            yield self._joined(-np.linspace(0.0, deep, count), np.zeros(count, dtype=np.int64))

    def _misfit(self, unknowns: FloatArray) -> float:
        r, _ = self.residual(unknowns)
        return float(np.sqrt(r @ r / len(r)))

    def _joined(self, height: FloatArray, which: IntArray) -> FloatArray:
        """Return the unknowns for heights [mm] and indices of tools, (n,) each."""
        if self.kit.range is None:
            return self.space.joined(height, which.astype(np.float64))
        exponents = np.array([_exponent(tool.cap) for tool in self.kit.tools])
        return self.space.joined(height, exponents[which])

    def _made(self, shape: FloatArray) -> tuple[FloatArray, Cap]:
        """Return the radii [mm] and caps of asperities with given shapes (n,)."""
        if self.kit.range is None:
            return self.kit.made(shape.astype(np.int64))
        caps = {n: Power(n, self.kit.range.coefficient) for n in np.unique(shape).tolist()}
        return np.full(len(shape), self.kit.radii[0]), Caps.of([caps[n] for n in shape.tolist()])

    def _fewest(self, height: FloatArray, shape: FloatArray) -> Mixture:
        """Return the asperities with the fewest tools that reach the goal, or with the smallest misfit."""
        if self.kit.range is None:
            return self._with_fewer(self._refined(height, shape))
        best: Mixture | None = None
        for fewer in self._reduced(shape):
            found = self._refined(height, fewer)
            best = found if best is None or found.misfit < best.misfit else best
            if best.misfit <= self.goal * FEWER:
                return best
        assert best is not None
        if self.restarts < FIXED_RESTARTS:
            return best
        return min(best, self._one_by_one(height, shape), key=lambda each: each.misfit)

    def _one_by_one(self, height: FloatArray, exponent: FloatArray) -> Mixture:
        """Return the asperities with exponents on their steps, after a few at a time moved to their steps.

        After each move, a descent of all heights and of the exponents that have not moved follows.
        """
        assert isinstance(self.space, OfExponents)
        range_, free = self.space.range, np.ones(len(height), dtype=bool)
        unknowns, misfit = self.space.joined(height, exponent), np.inf
        while free.any():
            height, exponent = self.space.split(unknowns)
            distance = np.where(free, np.abs(np.log(range_.nearest(exponent) / exponent)), np.inf)
            near = np.argsort(distance, kind="stable")[: 1 + int(free.sum()) // AT_ONCE]
            exponent[near], free[near] = range_.nearest(exponent[near]), False
            residual = self._with_free(np.concatenate([np.ones(len(free), dtype=bool), free]))
            given = self.space.joined(height, exponent), self.space, self.goal
            found = descend(residual, *given, options=self.problem.options)
            unknowns, misfit = found.unknowns, found.misfit
        height, exponent = self.space.split(unknowns)
        return Mixture(height, misfit, range_.nearest(exponent))

    def _with_free(self, free: NDArray[np.bool_]) -> Residual:
        """Return the residual with derivatives with respect to the free unknowns only, (2n,)."""

        def residual(unknowns: FloatArray) -> LateResidual:
            r, jacobian = self.residual(unknowns)
            return r, lambda: np.where(free, jacobian(), 0.0)

        return residual

    def _refined(self, height: FloatArray, shape: FloatArray, restarts: int | None = None) -> Mixture:
        """Return the asperities of given shapes with the best heights."""
        most = min(FIXED_RESTARTS, self.restarts) if restarts is None else restarts
        given = self.goal, most, self.rng, self.problem.options
        found = search(self._of_heights(shape), [height], self._heights, *given)
        return Mixture(found.unknowns, found.misfit, shape)

    def _with_fewer(self, best: Mixture) -> Mixture:
        """Return the asperities after tools whose asperities other tools can make are left out."""
        used, counts = np.unique(best.shape, return_counts=True)
        for tool in used[np.argsort(counts, kind="stable")].tolist():
            for other in np.setdiff1d(used, [tool]).tolist() if best.misfit <= FEWER * self.goal else ():
                fewer = np.where(best.shape == tool, other, best.shape)
                found = self._refined(best.unknowns, fewer, 0)
                if found.misfit <= FEWER * self.goal:
                    return self._with_fewer(found)
        return best

    def _reduced(self, shape: FloatArray) -> Iterator[FloatArray]:
        """Yield the exponents in fewer groups, fewest first, and last each on its own step."""
        assert self.kit.range is not None
        for number in NUMBERS:
            if number < len(np.unique(shape)):
                yield self.kit.range.nearest(grouped(shape, number))
        yield self.kit.range.nearest(shape)


@dataclass(frozen=True)
class Mixture:
    """Heights (n,) [mm], the misfit of their law [-], and the shapes of the caps, (n,)."""

    unknowns: FloatArray
    misfit: float
    shape: FloatArray


def grouped(exponent: FloatArray, number: int) -> FloatArray:
    """Return exponents (n,) replaced by the geometric means of groups of neighbouring exponents.

    Examples
    --------
    >>> grouped(np.array([2.0, 5.0, 8.0, 2.0]), 2).round(3)
    array([2.   , 6.325, 6.325, 2.   ])
    """
    x = np.log(exponent)
    centre = np.quantile(np.unique(x), (np.arange(number) + 0.5) / number)
    for _ in range(GROUPING_STEPS):
        group = np.abs(x[:, None] - centre).argmin(axis=1)
        size = np.bincount(group, minlength=number)
        mean = np.bincount(group, x, minlength=number) / np.maximum(size, 1)
        centre = np.where(size > 0, mean, centre)
    return np.asarray(np.exp(centre[np.abs(x[:, None] - centre).argmin(axis=1)]))


def _exponent(cap: Cap) -> float:
    assert isinstance(cap, Power)
    return float(cap.exponent)
