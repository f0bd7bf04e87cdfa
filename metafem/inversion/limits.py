"""Manufacturing limits: heights, sites with a prescribed height or none."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, refuse_if, shown
from metafem.surface import Surface

# Maximum number of height steps: finer steps are below the resolution of any machine and only cost time.
MOST_LEVELS = 100_000

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
        must = f"must be below max_height = {self.max_height:g} mm"
        refuse_if(self.span <= 0.0, must, key="min_height", value=self.min_height)
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


def pinned_heights(template: Surface, limits: Limits) -> dict[int, float | None]:
    """Return the prescribed heights by site [mm], increasing, or raise InvalidInput if they do not match."""
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
        found[int(site)] = (
            None if height is None else check.number(name, height, at_least=0.0, at_most=limits.top)
        )
        flat = height is not None and found[int(site)] == 0.0 and template.block is not None
        refuse_if(flat, "is no summit of a part; leave the site empty", key=name, value=0.0)
    empty = sum(height is None for height in found.values())
    words = f"pinned leaves all {template.count} sites empty; leave out at least one site"
    refuse_if(empty == template.count, words)
    return dict(sorted(found.items()))
