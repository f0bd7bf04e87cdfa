"""What an inversion hands to the design: heights and how to judge them."""

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
    """A straight branch that the law should have: slope [-] and intercept [mm^2] over rescaled loads.

    The intercept is None where the target leaves it open.
    """

    slope: float
    load_range: tuple[float, float]
    intercept: float | None = None


@dataclass(frozen=True, eq=False)
class Blueprint:
    """Heights above the base plane, tallest first (n,) [mm], with their radii, and what they are to achieve.

    `wanted` is the law that heights for another model are to have; `stepped` heights stand on the
    levels of the limits already. Where points are to be met exactly, summits that another model needs in
    addition start below `spare_height` [mm].
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
