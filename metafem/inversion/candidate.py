"""Candidate heights for a problem, and the law to which their law is compared."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.caps import Cap
from metafem.errors import Infeasible
from metafem.inversion.height_density import ExponentialDensity
from metafem.inversion.limits import Limits
from metafem.inversion.search.target_law import TargetLaw
from metafem.notes import Note
from metafem.surface import Surface

Parameter = float | int | FloatArray | IntArray

# Number of loads at which the slope of a straight branch is fitted.
BRANCH_POINTS = 76

# Parameters of designs for operating points that are no longer valid after the heights change.
LEVELS = (
    "counts", "levels", "adjustment_heights", "adjustment_counts", "level_radii", "adjustment_radii",
)  # fmt: skip


@dataclass(frozen=True)
class Branch:
    """A straight branch of the target: slope [-] and intercept [mm^2] over a range of rescaled loads.

    The intercept is None if the target leaves it free.
    """

    slope: float
    load_range: tuple[float, float]
    intercept: float | None = None

    @property
    def load(self) -> FloatArray:
        """Rescaled loads at which the slope is fitted, (76,) [mm^2]."""
        return np.linspace(*self.load_range, BRANCH_POINTS)


@dataclass(frozen=True, eq=False)
class Candidate:
    """Heights above the base plane (n,) [mm] with their radii and caps, and data for the design.

    A strategy returns the heights of independent asperities, tallest first and without `sites`. The later
    steps of a design assign the heights to sites of the template and may change them.

    - `target_law`: law of the target or of a height density, to which the law of the heights is compared.
    - `stepped`: whether the heights are already on the levels of the limits.
    - `lowest_level` [mm]: set only if points must be met exactly. Asperities for another model can be added
      below this height.
    - `sites` (n,): sites of the asperities in the template, increasing.
    - `moved`: whether the heights differ from those of independent asperities.
    - `unrounded` [-]: misfit before the heights were rounded to steps.
    - `held` (k,): sites with prescribed heights.
    - `unpinned` [-]: misfit without the prescribed heights.
    - `refusal`: function that returns the error for heights that miss the target under the model, set only if
      independent asperities do not meet the target.
    - `cap`: the caps, or None if all have the cap of the template.
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
    held: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    unpinned: float | None = None
    refusal: Callable[[], Infeasible] | None = None
    cap: Cap | None = None

    @property
    def held_rows(self) -> IntArray:
        """Indices of the prescribed heights, (k,)."""
        return np.searchsorted(self.sites, self.held)

    def surface(self, template: Surface) -> Surface:
        """Return the surface on the sites of a template; without sites, on its first ones."""
        some = self.sites if self.sites.size else np.arange(len(self.height))
        cap = template.cap.at(some) if self.cap is None else self.cap
        return template.only(some, height=self.height, radius=self.radius, cap=cap)

    def taken(self, rows: IntArray) -> Candidate:
        """Return the candidate with the asperities of some rows, in their order, which may repeat."""
        cap = None if self.cap is None else self.cap.at(rows)
        return replace(self, height=self.height[rows], radius=self.radius[rows], cap=cap)

    def placed(self, sites: IntArray, foot: float = -np.inf) -> Candidate:
        """Return the candidate on sites (n,) in any order; heights below the foot [mm] are raised to it."""
        order = np.argsort(sites)
        found = self.taken(order)
        return replace(found, sites=sites[order], height=np.maximum(found.height, foot))

    def with_heights(self, height: FloatArray) -> Candidate:
        """Return the candidate with changed heights on the same sites, without the parameters of levels."""
        parameters = dict(self.parameters)
        if self.lowest_level is not None:
            rest = {name: value for name, value in parameters.items() if name not in LEVELS}
            parameters = {"span": 0.0, **rest}
        if "span" in parameters:
            parameters["span"] = float(np.ptp(height))
        return replace(self, height=height, parameters=parameters, moved=True)


def below_limit(height: FloatArray, limits: Limits) -> FloatArray:
    """Return heights shifted together so that the tallest has the largest allowed height, (n,) [mm].

    The shift changes the law only if the model includes the compliance of the caps.
    """
    return np.asarray(np.maximum(limits.top - (height.max() - height), limits.foot))
