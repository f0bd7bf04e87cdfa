"""Allowed radii of asperities: one, those of a list of tools, or any of a range."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._given import Given
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.surface import Surface

# Default distance of the radii of a range [mm]: of the order of the tolerance of ball-end tools.
STEP = 0.01

# Decimals of a radius in mm: removes the rounding error of a multiple of a step.
DECIMALS = 12

# Relative excess of a step over its range that is treated as rounding.
ROUNDING = 1e-9

# Number of single radii of a range that are tried, evenly spaced in the logarithm.
TRIED_RADII = 7


@dataclass(frozen=True)
class RadiusRange:
    """Range of allowed radii of each asperity.

    Parameters
    ----------
    low, high : float
        Smallest and largest radius [mm], positive and increasing.
    step : float, optional
        Radii between them are multiples of this [mm]; default: 0.01, of the order of the tolerance of
        ball-end tools. None allows any radius.

    Raises
    ------
    InvalidInput
        If `low` or `step` is not positive, `high` does not exceed `low`, or `step` exceeds ``high - low``.

    Examples
    --------
    >>> RadiusRange(0.2, 0.8).high
    0.8
    """

    low: float
    high: float
    step: float | None = STEP

    def __post_init__(self) -> None:
        check.member(self, "low", above=0.0)
        check.member(self, "high", above=self.low)
        check.member(self, "step", optional=True, above=0.0)
        wide = self.step is not None and self.step > (self.high - self.low) * (1.0 + ROUNDING)
        words = "exceeds the range from {.number} to {.number}; give a smaller step, or none"
        ends = Given("low", self.low), Given("high", self.high)
        refuse_if(wide, words, *ends, key="step", value=self.step)


@dataclass(frozen=True)
class Radii:
    """Allowed radii of each asperity [mm]: one of the tools, increasing, or any from low to high.

    With a `step` [mm] the radii between low and high are multiples of it.
    """

    low: float
    high: float
    tools: tuple[float, ...] | None
    step: float | None = None

    @classmethod
    def of(cls, radius: float) -> Radii:
        """One radius for all."""
        return cls(radius, radius, (radius,))

    @classmethod
    def given(cls, radii: RadiusRange | Sequence[float] | None, template: Surface | None = None) -> Radii:
        """A range, a list of tools, or by default the common radius of a template."""
        if isinstance(radii, RadiusRange):
            return cls(radii.low, radii.high, None, radii.step)
        if radii is None and template is not None:
            radius = template.radius
            refuse_if(
                (radius != radius[0]).any(),
                f"template.radius runs from {radius.min():g} to {radius.max():g} mm; one common radius is "
                "needed here, and the argument radii allows several",
            )
            return cls.of(float(radius[0]))
        tools = np.unique(check.array("radii", radii, shape=(None,)))
        refuse_if(tools[0] <= 0.0, f"radii holds {tools[0]:g}; all must be greater than 0")
        return cls(float(tools[0]), float(tools[-1]), tuple(tools.tolist()))

    @property
    def single(self) -> bool:
        """Whether only one radius is possible."""
        return self.low == self.high

    @property
    def tried(self) -> FloatArray:
        """The tools, or some radii of the range, increasing [mm]."""
        if self.tools is None:
            between = self.nearest(np.geomspace(self.low, self.high, TRIED_RADII))
            return np.union1d([self.low, self.high], between)
        return np.array(self.tools)

    @property
    def continuous(self) -> bool:
        """Whether radii can change by any amount."""
        return self.tools is None and self.step is None

    def tried_beside(self, best: float, count: int) -> FloatArray:
        """Return at most `count` radii between a tried radius and its neighbours [mm]."""
        tried = self.tried
        i = int(np.argmin(np.abs(tried - best)))
        low, high = tried[max(i - 1, 0)], tried[min(i + 1, len(tried) - 1)]
        sides = [np.geomspace(low, best, 2 + count // 2), np.geomspace(best, high, 2 + count // 2)]
        between = np.concatenate([side[1:-1] for side in sides])
        return np.setdiff1d(self.nearest(between), tried)

    @property
    def given_as(self) -> RadiusRange | tuple[float, ...]:
        """The range or the tools."""
        return RadiusRange(self.low, self.high, self.step) if self.tools is None else self.tools

    @property
    def between(self) -> Radii:
        """Any radius from the smallest to the largest."""
        return Radii(self.low, self.high, None)

    @property
    def extremes(self) -> Radii:
        """Only the smallest and the largest radius."""
        return Radii(self.low, self.high, (self.low, self.high))

    def nearest(self, radius: FloatArray) -> FloatArray:
        """Return the allowed radii nearest, by ratio, to given ones [mm]."""
        if self.tools is None:
            if self.step is not None:
                radius = np.round(self.step * np.rint(radius / self.step), DECIMALS)
            return np.clip(radius, self.low, self.high)
        tools = np.array(self.tools)
        return np.asarray(tools[np.abs(np.log(radius[:, None] / tools)).argmin(axis=1)])

    def __str__(self) -> str:
        if self.single:
            return f"radius {self.low:g} mm"
        return f"radii from {self.low:g} to {self.high:g} mm"
