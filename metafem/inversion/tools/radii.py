"""Choice of the radius of each asperity, for caps of one shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.inversion.tools.ranges import RadiusRange, on_steps
from metafem.surface import Surface

# Number of logarithmically spaced radii of a range that are tried as a common radius.
TRIED_RADII = 7


@dataclass(frozen=True)
class Radii:
    """Allowed radii of each asperity [mm]: the `tools`, increasing, or any radius from `low` to `high`.

    With a `step` [mm] the radii between `low` and `high` are multiples of the step.
    """

    low: float
    high: float
    tools: tuple[float, ...] | None
    step: float | None = None

    @classmethod
    def of(cls, radius: float) -> Radii:
        """Return the choice of a single radius [mm] for all asperities."""
        return cls(radius, radius, (radius,))

    @classmethod
    def given(cls, radii: RadiusRange | Sequence[float] | None, template: Surface | None = None) -> Radii:
        """Return the choice for a range or a list of tools; default: the common radius of a template."""
        if isinstance(radii, RadiusRange):
            return cls(radii.low, radii.high, None, radii.step)
        if radii is None and template is not None:
            radius = template.radius
            refuse_if(
                (radius != radius[0]).any(),
                f"template.radius runs from {radius.min():g} to {radius.max():g} mm; one common radius is "
                "needed here, and the argument tools allows several",
            )
            return cls.of(float(radius[0]))
        tools = np.unique(check.array("tools", radii, shape=(None,)))
        refuse_if(tools[0] <= 0.0, f"tools holds a radius of {tools[0]:g} mm; all must be greater than 0")
        return cls(float(tools[0]), float(tools[-1]), tuple(tools.tolist()))

    @property
    def single(self) -> bool:
        """Whether only one radius is possible."""
        return self.low == self.high

    @property
    def tried(self) -> FloatArray:
        """Radii that are tried as a common radius: all tools, or some radii of the range, increasing [mm]."""
        if self.tools is None:
            between = self.nearest(np.geomspace(self.low, self.high, TRIED_RADII))
            return np.union1d([self.low, self.high], between)
        return np.array(self.tools)

    @property
    def continuous(self) -> bool:
        """Whether radii can change by any amount."""
        return self.tools is None and self.step is None

    @property
    def given_as(self) -> RadiusRange | tuple[float, ...]:
        """The range or the tools, as in the argument `tools` of `design`."""
        if self.tools is not None:
            return self.tools
        assert self.step is not None
        return RadiusRange(self.low, self.high, self.step)

    @property
    def between(self) -> Radii:
        """Choice of any radius from the smallest to the largest."""
        return Radii(self.low, self.high, None)

    @property
    def extremes(self) -> Radii:
        """Choice of only the smallest and the largest radius."""
        return Radii(self.low, self.high, (self.low, self.high))

    def nearest(self, radius: FloatArray) -> FloatArray:
        """Return the nearest allowed radius for each radius [mm]; tools are compared by their ratio."""
        if self.tools is None:
            return on_steps(radius, self.low, self.high, self.step)
        tools = np.array(self.tools)
        return np.asarray(tools[np.abs(np.log(radius[:, None] / tools)).argmin(axis=1)])

    def __str__(self) -> str:
        if self.single:
            return f"radius {self.low:g} mm"
        return f"radii from {self.low:g} to {self.high:g} mm"
