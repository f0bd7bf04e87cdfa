"""Assignment of the heights of a design to its sites that makes the law insensitive to a tilt of the plane.

A tilt by (t_x, t_y) raises the summits by ``x_i t_x + y_i t_y``. For independent asperities, this changes A0
at a fixed load by the change of ``sum_i A(d_i) - dA0/dP sum_i P(d_i)``, with the indentations d_i at a fixed
separation. An exchange of two asperities changes the terms of two sites alone, so that the effects of all
exchanges are predicted at once. The best exchanges are made, and kept if the change under the model is less.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem._values import percent
from metafem.inversion.design import assessed, refinable
from metafem.inversion.problem import NONE, Asperities, Candidate, Problem
from metafem.inversion.refinement import refined
from metafem.inversion.result import DOUBT, Design, DesignStatus
from metafem.models.model import contact_of
from metafem.notes import information
from metafem.progress import doing, each
from metafem.surface import STEEPEST, Surface

# Number of loads, and of evenly spaced directions of the tilt: five or more give the exact mean square over
# all directions for changes of up to second order in the tilt.
LOADS, DIRECTIONS = 10, 6

# Number of searches from random exchanges of the best assignment, for up to FEW asperities; one for more.
ROUNDS, FEW = 8, 128

# Maximum number of sites among which exchanges are predicted, of exchanges before the model is evaluated, and
# of evaluations of one search.
SITES, EXCHANGES, EVALUATIONS = 96, 16, 24


@doing("assigning heights to sites")
def arrange(design: Design, tilt: float, rng: Any = 0) -> Design:
    """Return the design with its asperities exchanged between their sites, to reduce the effect of a tilt.

    The rms change of A0 over the loads of the target and six directions of the tilt is reduced under the
    model of the design, or under its `gradient_model`. Under a model with interaction the heights are then
    refined again, unless they are on steps or some are prescribed. Prescribed heights keep their sites.

    Parameters
    ----------
    design : Design
    tilt : float
        Misalignment of the plane [rad], up to pi/4.
    rng : int or numpy Generator
        Seed of the random exchanges.

    Returns
    -------
    Design
        Its parameters ``tilt_before`` and ``tilt_after`` [-] are the rms changes before and after the
        exchanges.

    Raises
    ------
    InvalidInput
        If an argument is outside its range or of the wrong kind, or the surface has a periodic cell.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> found = mf.arrange(mf.design(mf.LinearLaw(6.87), template), tilt=0.001)
    >>> found.parameters["tilt_after"] < 0.2 * found.parameters["tilt_before"]
    True
    """
    check.instance("design", design, Design, "a metafem.Design")
    angle = check.number("tilt", tilt, above=0.0, at_most=STEEPEST)
    design.surface.refuse_tilt()
    generator = check.generator(rng)
    load = design.target_law.load
    some = np.unique(np.linspace(0, len(load) - 1, min(len(load), LOADS)).round().astype(np.int64))
    held = np.array([site for site, height in design.pinned.items() if height is not None])
    free = np.flatnonzero(~np.isin(design.sites, held))
    search = _Search(design.surface, free, design.law.model.gradient_model, load[some], angle)
    first = np.arange(design.surface.count)
    found = search.best(first, generator)
    before, after = (search.rms(search.change(order)) for order in (first, found))
    problem = Problem.checked(
        design.target, design.template, design.law.model, design.limits, tools=design.tools
    )
    rms = {"tilt_before": before, "tilt_after": after}
    candidate = _candidate(design, search.placed(found), problem, rms)
    if not held.size and refinable(problem, candidate):
        candidate = refined(problem, candidate, generator)
    words = f"a tilt of {math.degrees(angle):.3g} deg changes A0 by {percent(after)} (rms)"
    note = information(f"{words}; before heights were exchanged between sites it was {percent(before)}")
    kept = tuple(each for each in design.notes if each not in design.law.notes and each.quantity != DOUBT)
    new = tuple(each for each in candidate.notes if each not in kept)
    return assessed(problem, replace(candidate, notes=(*kept, *new, note)))


def _candidate(design: Design, surface: Surface, problem: Problem, rms: dict[str, float]) -> Candidate:
    """Return the candidate with the heights of a surface on the sites of a design."""
    made = {(tool.radius, tool.cap): i for i, tool in enumerate(problem.tools.all)}
    height, tool = np.zeros(design.template.count), np.full(design.template.count, NONE)
    height[design.sites] = surface.height
    pairs = ((radius, surface.cap.one(i)) for i, radius in enumerate(surface.radius.tolist()))
    tool[design.sites] = [made[pair] for pair in pairs]
    return Candidate(
        Asperities(height, tool), design.target_law, found={**design.parameters, **rms},
        branches=tuple(branch for branch, _ in design.fits), density=design.density,
        stepped=design.limits.height_step is not None,
        refined=design.status in (DesignStatus.REFINED, DesignStatus.ADJUSTED),
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Search:
    """The surface, its sites that may be exchanged, the model, the loads [mm^2] and the tilt [rad].

    An assignment is the asperity at each site, (n,).
    """

    surface: Surface
    free: IntArray
    model: Any
    load: FloatArray
    angle: float

    def placed(self, order: IntArray) -> Surface:
        """Return the surface of an assignment."""
        return self.surface.only(order, position=self.surface.position)

    def change(self, order: IntArray) -> FloatArray:
        """Return the relative changes of A0 of an assignment under the model, over tilts and loads, (q,)."""
        surface = self.placed(order)
        heights = surface.height + np.vstack([np.zeros(surface.count), self._lifts])
        level, *tilted = self.model.areas(surface, self.load, heights)
        return np.ravel(tilted / level - 1.0)

    def rms(self, change: FloatArray) -> float:
        """Return the root mean square of changes [-]."""
        return float(np.sqrt((change**2).mean()))

    def best(self, first: IntArray, rng: np.random.Generator) -> IntArray:
        """Return the best assignment of searches from the first and from random exchanges of the best."""
        best, least = self._descended(first, rng)
        for _ in each("round", range(1, ROUNDS if self.surface.count <= FEW else 1)):
            order = best.copy()
            for _ in range(max(2, len(self.free) // 10)):
                pair = rng.choice(self.free, 2)
                order[pair] = order[pair[::-1]]
            best, least = min((best, least), self._descended(order, rng), key=lambda found: found[1])
        return best

    def _descended(self, order: IntArray, rng: np.random.Generator) -> tuple[IntArray, float]:
        """Return an assignment after exchanges, fewer at a time after a failed step, and its rms change."""
        most, change = max(EXCHANGES, len(self.free) // 4), self.change(order)
        for _ in range(EVALUATIONS):
            trial = self._exchanged(order, change, most, rng)
            if self.rms(found := self.change(trial)) < self.rms(change):
                order, change = trial, found
            elif most == 1:
                break
            else:
                most = max(1, most // 3)
        return order, self.rms(change)

    def _exchanged(
        self, start: IntArray, change: FloatArray, most: int, rng: np.random.Generator
    ) -> IntArray:
        """Return the assignment (n,) after at most `most` exchanges, each with the least predicted change."""
        sites = self.free if len(self.free) <= SITES else rng.choice(self.free, SITES, replace=False)
        values, at = self._values(self.placed(start), sites), np.arange(len(sites))
        for _ in range(most):
            moved = values[:, at]
            own = np.diagonal(moved, axis1=1, axis2=2)
            trial = change[:, None, None] + moved + moved.transpose(0, 2, 1)
            trial -= own[:, :, None] + own[:, None, :]
            squares = (trial**2).sum(axis=0)
            a, b = np.unravel_index(int(squares.argmin()), squares.shape)
            if a == b:
                break
            change, at[[a, b]] = trial[:, a, b], at[[b, a]]
        order = start.copy()
        order[sites] = start[sites[at]]
        return order

    def _values(self, surface: Surface, sites: IntArray) -> FloatArray:
        """Return the predicted terms of the asperity of each site at each site, (q, m, m) [-]."""
        found, law = self.model.sensitivity(surface, self.load), contact_of(self.model).bound(surface)
        radius = np.broadcast_to(law.summits(surface), surface.count)
        a = law.contact_radius(found.indentation, radius)
        rate = law.area_slope(a, radius).sum(axis=1) / law.stiffness(a, radius).sum(axis=1)
        depth = found.indentation[:, sites][None, :, :, None] + self._lifts[:, sites][:, None, None, :]
        size = radius[sites][:, None]
        a = law.contact_radius(depth, size)
        terms = law.area(a) - rate[:, None, None] * law.load(a, size)
        return np.asarray((terms / found.curve.area[:, None, None]).reshape(-1, len(sites), len(sites)))

    @property
    def _lifts(self) -> FloatArray:
        """Rise of each site by each tilt, (t, n) [mm]."""
        direction = 2.0 * math.pi * np.arange(DIRECTIONS) / DIRECTIONS
        slope = math.tan(self.angle) * np.stack([np.cos(direction), np.sin(direction)], axis=1)
        return np.asarray(slope @ self.surface.position.T)
