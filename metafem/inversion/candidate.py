"""Candidate heights of a problem, and the law with which they are compared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.inversion.height_density import ExponentialDensity
from metafem.inversion.limits import Limits
from metafem.inversion.search.target_law import TargetLaw
from metafem.notes import Note
from metafem.surface import Surface

Parameter = float | int | FloatArray | IntArray

# Number of loads at which the slope of a straight branch is fitted.
BRANCH_POINTS = 76

# Parameters of operating points that are not valid for moved heights.
LEVELS = ("counts", "levels", "adjustment_heights", "level_radii", "adjustment_radii")


@dataclass(frozen=True)
class Branch:
    """A straight branch of the target: slope [-] and intercept [mm^2] over a range of rescaled loads.

    The intercept is None where the target leaves it open.
    """

    slope: float
    load_range: tuple[float, float]
    intercept: float | None = None

    @property
    def load(self) -> FloatArray:
        """Rescaled loads at which the slope is fitted [mm^2]."""
        return np.linspace(*self.load_range, BRANCH_POINTS)


@dataclass(frozen=True, eq=False)
class Candidate:
    """Heights above the base plane (n,) [mm] with their radii, and data for the design.

    A strategy returns the heights of independent asperities, tallest first and without `sites`. The later
    steps of a design assign them to sites of the template and may move them.

    The law of the heights is compared with `target_law`, that of the target or of a height density.
    `stepped` heights are already on the levels of the limits; `moved` heights differ from those of
    independent asperities; `unrounded` is the misfit before heights were rounded to steps. `lowest_level`
    [mm] is set for points that must be met exactly: asperities for another model can be added below it.
    `sites` (n,) are those of the template, increasing. `robust` heights have a smaller expected misfit than
    others that reach the target. `held` (k,) are sites with given, fixed heights; `unpinned` is the
    misfit without them.
    """

    height: FloatArray
    radius: FloatArray
    parameters: Mapping[str, Parameter]
    target_law: TargetLaw
    branches: tuple[Branch, ...] = ()
    density: ExponentialDensity | None = None
    notes: tuple[Note, ...] = ()
    stepped: bool = False
    lowest_level: float | None = None
    sites: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    moved: bool = False
    unrounded: float | None = None
    robust: bool = False
    held: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    unpinned: float | None = None

    @property
    def held_rows(self) -> IntArray:
        """Indices of the fixed heights, (k,)."""
        return np.searchsorted(self.sites, self.held)

    def surface(self, template: Surface) -> Surface:
        """Return the surface of the heights on their sites of a template."""
        position = template.position[self.sites]
        return template.replaced(position=position, height=self.height, radius=self.radius)

    def placed(self, sites: IntArray, foot: float = -np.inf) -> Candidate:
        """Return the heights on sites in any order (n,), clipped at the foot [mm] against rounding."""
        order = np.argsort(sites)
        height = np.maximum(self.height[order], foot)
        return replace(self, sites=sites[order], height=height, radius=self.radius[order])

    def with_heights(self, height: FloatArray) -> Candidate:
        """Return the candidate with changed heights on the same sites, without levels as parameters."""
        parameters = dict(self.parameters)
        if self.lowest_level is not None:
            rest = {name: value for name, value in parameters.items() if name not in LEVELS}
            parameters = {"span": 0.0, **rest}
        if "span" in parameters:
            parameters["span"] = float(np.ptp(height))
        return replace(self, height=height, parameters=parameters, moved=True)


def below_limit(height: FloatArray, limits: Limits) -> FloatArray:
    """Return heights shifted together so that the tallest is at the limit.

    The shift changes the law only of models that include the compliance of the caps.
    """
    return np.asarray(np.maximum(limits.top - (height.max() - height), limits.foot))
