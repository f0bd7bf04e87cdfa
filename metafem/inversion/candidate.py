"""Candidate asperities for a problem, and the law to which their law is compared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from metafem._validate import FloatArray
from metafem.inversion.density import ExponentialDensity
from metafem.inversion.problem import Asperities, Parameter
from metafem.inversion.target_law import TargetLaw
from metafem.notes import Note

# Number of loads at which the slope of a straight branch is fitted.
BRANCH_POINTS = 76


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
    """Asperities, the law of the target or of a height density, and data for the design.

    - `parameters`: quantities of the design that hold for these asperities alone, such as levels.
    - `found`: quantities that were found on the way.
    - `stepped`: whether the heights are on the levels of the limits.
    - `refined`: whether the heights were changed under the model.
    - `unrounded` [-]: misfit before the heights were rounded to steps.
    """

    asperities: Asperities
    law: TargetLaw
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    found: Mapping[str, Parameter] = field(default_factory=dict)
    branches: tuple[Branch, ...] = ()
    density: ExponentialDensity | None = None
    notes: tuple[Note, ...] = ()
    stepped: bool = False
    refined: bool = False
    unrounded: float | None = None

    def with_asperities(self, at: Asperities) -> Candidate:
        """Return the candidate with other asperities, without the parameters of the former ones."""
        return replace(self, asperities=at, parameters={})
