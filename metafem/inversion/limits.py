"""Manufacturing limits: heights, sites with a prescribed height or none, and allowed radii."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._given import Given, shown
from metafem._validate import FloatArray, IntArray
from metafem.errors import InvalidInput, refuse_if
from metafem.surface import Surface

# Maximum number of height steps: finer steps are below the resolution of any machine and only cost time.
MOST_LEVELS = 100_000

# Default spacing of the radii of a range [mm], of the order of the tolerance of ball-end tools.
STEP = 0.01

# Radii in mm are rounded to this many decimals, which removes the rounding error of multiples of a step.
DECIMALS = 12

# A step may exceed its range by this fraction, which is treated as rounding.
ROUNDING = 1e-9

# Number of logarithmically spaced radii of a range that are tried as a common radius.
TRIED_RADII = 7

# Heights [mm] above the base plane by site, None for a site without an asperity.
Pinned = Mapping[int, float | None]


@dataclass(frozen=True)
class Limits:
    """Manufacturing limits of the heights; the height of a summit is ``offset + h``.

    Parameters
    ----------
    max_height : float
        Largest h [mm], positive. The first level of operating points is at this height. Exponential
        densities extend from min_height to this height.
    min_height : float
        Smallest h [mm], not negative and below max_height.
    offset : float
        Height h_0 that is added to all heights [mm], not negative. With it the lowest summits can be indented
        before the plane reaches the base plane. It does not change the law.
    height_step : float, optional
        Spacing of the allowed heights [mm]. They are the middles of steps that start at the smallest height.
        Default: any height is possible.
    height_sd : float, optional
        Standard deviation of the manufactured heights [mm]. A note warns if a design is too fine for it.
    pinned : mapping of int to float or None
        Prescribed heights above the base plane [mm]. The keys are the numbers of the sites in the template of
        the design; the value None means a site without an asperity. Default: no prescribed heights.

    Raises
    ------
    InvalidInput
        If a value is outside its range.

    Examples
    --------
    >>> Limits(max_height=0.120, offset=0.084, height_step=0.006).span
    0.12
    """

    max_height: float
    min_height: float = 0.0
    offset: float = 0.0
    height_step: float | None = None
    height_sd: float | None = None
    pinned: Mapping[int, float | None] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        check.member(self, "max_height", above=0.0)
        for name in ("min_height", "offset"):
            check.member(self, name, at_least=0.0)
        top = Given("max_height", self.max_height)
        refuse_if(self.span <= 0.0, "must be below {}", top, key="min_height", value=self.min_height)
        finest = self.span / MOST_LEVELS
        check.member(self, "height_step", optional=True, at_least=finest, at_most=self.span)
        check.member(self, "height_sd", optional=True, at_least=0.0)

    @property
    def span(self) -> float:
        """Range of the heights, max_height - min_height [mm]."""
        return self.max_height - self.min_height

    @property
    def levels(self) -> FloatArray:
        """Allowed heights above the base plane with a height step, increasing, (l,) [mm]."""
        if self.height_step is None:
            raise InvalidInput("height_step is None; heights may have any value")
        number = max(1, math.floor(self.span / self.height_step + 0.5))
        return np.asarray(self.foot + self.height_step * (np.arange(number) + 0.5))

    @property
    def top(self) -> float:
        """Height of the tallest possible summit above the base plane, offset + max_height [mm]."""
        return self.offset + self.max_height

    @property
    def foot(self) -> float:
        """Height of the lowest possible summit above the base plane, offset + min_height [mm]."""
        return self.offset + self.min_height


@dataclass(frozen=True, eq=False)
class Pins:
    """A template, and its sites that must be empty or have a prescribed height.

    An inversion uses only the sites that may have an asperity, and numbers them anew: `open` (m,) holds
    their numbers in the template. The sites ``open[rows]`` have the prescribed heights `heights` (k,) [mm].
    """

    template: Surface
    pinned: Pinned

    @classmethod
    def given(cls, template: Surface, limits: Limits) -> Pins:
        """Return the pins of the limits, or raise InvalidInput if they do not match the template."""
        pinned: Any = limits.pinned
        words = "a mapping of site numbers to heights [mm] or None, for example {9: 0.15, 3: None}"
        check.instance("pinned", pinned, Mapping, words)
        found: dict[int, float | None] = {}
        last = template.count - 1
        for site, height in pinned.items():
            name = f"pinned[{shown(site)}]"
            whole = isinstance(site, (int, np.integer)) and not isinstance(site, (bool, np.timedelta64))
            known = whole and 0 <= site <= last
            refuse_if(not known, f"{name} is not a site: the template has the sites 0 to {last}")
            found[int(site)] = None if height is None else _checked_height(name, height, limits)
            flat = height is not None and found[int(site)] == 0.0 and template.block is not None
            refuse_if(flat, f"{name} = 0 is no summit of a part; write None for an empty site")
        pins = cls(template, MappingProxyType(dict(sorted(found.items()))))
        words = f"pinned leaves all {template.count} sites empty; leave out at least one site"
        refuse_if(not pins.open.size, words)
        return pins

    @cached_property
    def open(self) -> IntArray:
        """Sites of the template that may have an asperity, increasing, (m,)."""
        empty = [site for site, height in self.pinned.items() if height is None]
        return np.setdiff1d(np.arange(self.template.count), np.array(empty, dtype=np.int64))

    @cached_property
    def rows(self) -> IntArray:
        """Indices in `open` of the sites with prescribed heights, increasing, (k,)."""
        sites = [site for site, height in self.pinned.items() if height is not None]
        return np.searchsorted(self.open, np.array(sites, dtype=np.int64))

    @cached_property
    def heights(self) -> FloatArray:
        """Prescribed heights above the base plane at the sites `rows`, (k,) [mm]."""
        return np.array([height for height in self.pinned.values() if height is not None], dtype=np.float64)

    def placed(self, permutation: IntArray) -> IntArray:
        """Return a permutation of all template sites without the empty sites, as indices in `open`, (m,)."""
        number = np.full(self.template.count, -1)
        number[self.open] = np.arange(len(self.open))
        found = number[permutation]
        return np.asarray(found[found >= 0])

    @cached_property
    def reduced(self) -> Surface:
        """The template without the empty sites."""
        template, some = self.template, self.open
        if len(some) == template.count:
            return template
        return template.replaced(
            position=template.position[some], height=template.height[some], radius=template.radius[some]
        )


def _checked_height(name: str, height: Any, limits: Limits) -> float:
    """Return a height above the base plane [mm], or raise InvalidInput if it is outside the limits."""
    found = check.number(name, height, at_least=0.0)
    must = "must be at most {.number}, limits.offset + limits.max_height, which are measured from the base "
    refuse_if(
        found > limits.top, must + "plane as this height is", Given(name, limits.top), key=name, value=found
    )
    return found


@dataclass(frozen=True)
class RadiusRange:
    """Range of allowed radii of each asperity.

    Parameters
    ----------
    low, high : float
        Smallest and largest radius [mm], positive and increasing.
    step : float, optional
        Radii between `low` and `high` are multiples of this step [mm]. Default: 0.01, of the order of the
        tolerance of ball-end tools. None allows any radius.

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
        """Radii that are tried as a common radius: all tools, or some radii of the range, increasing [mm]."""
        if self.tools is None:
            between = self.nearest(np.geomspace(self.low, self.high, TRIED_RADII))
            return np.union1d([self.low, self.high], between)
        return np.array(self.tools)

    @property
    def continuous(self) -> bool:
        """Whether radii can change by any amount."""
        return self.tools is None and self.step is None

    def tried_beside(self, best: float, count: int) -> FloatArray:
        """Return at most `count` radii [mm] between the tried radius `best` and its tried neighbours."""
        tried = self.tried
        i = int(np.argmin(np.abs(tried - best)))
        low, high = tried[max(i - 1, 0)], tried[min(i + 1, len(tried) - 1)]
        sides = [np.geomspace(low, best, 2 + count // 2), np.geomspace(best, high, 2 + count // 2)]
        between = np.concatenate([side[1:-1] for side in sides])
        return np.setdiff1d(self.nearest(between), tried)

    @property
    def given_as(self) -> RadiusRange | tuple[float, ...]:
        """The range or the tools, as in the argument `radii` of `design`."""
        return RadiusRange(self.low, self.high, self.step) if self.tools is None else self.tools

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
            if self.step is not None:
                radius = np.round(self.step * np.rint(radius / self.step), DECIMALS)
            return np.clip(radius, self.low, self.high)
        tools = np.array(self.tools)
        return np.asarray(tools[np.abs(np.log(radius[:, None] / tools)).argmin(axis=1)])

    def __str__(self) -> str:
        if self.single:
            return f"radius {self.low:g} mm"
        return f"radii from {self.low:g} to {self.high:g} mm"
