"""Result of an inversion: heights, and the law with which they are compared."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from metafem._validate import FloatArray, IntArray
from metafem.inversion.height_density import PiecewiseExponential
from metafem.inversion.targets.wanted import Wanted
from metafem.notes import Note

Parameter = float | int | FloatArray | IntArray


@dataclass(frozen=True)
class Branch:
    """A straight branch of the target: slope [-] and intercept [mm^2] over a range of rescaled loads.

    The intercept is None where the target leaves it open.
    """

    slope: float
    load_range: tuple[float, float]
    intercept: float | None = None


@dataclass(frozen=True, eq=False)
class Blueprint:
    """Heights above the base plane, tallest first (n,) [mm], with their radii and the target law.

    `wanted` is the target of a refinement under another model. `stepped` heights are already on the levels
    of the limits. Where points are to be met exactly, asperities that another model needs in addition
    start below `spare_height` [mm].
    """

    height: FloatArray
    radius: FloatArray
    parameters: Mapping[str, Parameter]
    wanted: Wanted
    branches: tuple[Branch, ...] = ()
    density: PiecewiseExponential | None = None
    notes: tuple[Note, ...] = field(default=())
    stepped: bool = False
    spare_height: float | None = None

    @property
    def exact(self) -> bool:
        """Whether points are to be met exactly."""
        return self.spare_height is not None
