"""Manufacturing limits."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from metafem import _validate as check
from metafem._given import Given
from metafem._validate import FloatArray
from metafem.errors import InvalidInput, refuse_if

# Steps finer than this are below the resolution of any machine and would only cost time.
MOST_LEVELS = 100_000


@dataclass(frozen=True)
class Limits:
    """Manufacturing limits of the heights; the height of a summit is ``offset + h``.

    Parameters
    ----------
    max_height : float
        Largest h [mm], positive; the h_m of the exponential densities and the first level of
        operating points.
    min_height : float
        Smallest h [mm], below max_height; the lower end of the densities.
    offset : float
        Height h_0 added to all heights [mm], not negative, so that the lowest summits can be indented
        before the plane reaches the base plane. It does not change the law.
    height_step : float, optional
        Spacing of the allowed heights [mm], which are the middles of the steps above the foot; default: any
        height is possible.
    height_sd : float, optional
        Standard deviation of the manufactured heights [mm]; a note warns of designs that are too fine for it.
    pinned : mapping of int to float or None
        Heights [mm] above the base plane of some sites, by their numbers in the template of a design, or None
        for a site without an asperity; default: no pinned sites.

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
        """Possible heights above the base plane with a height step, increasing [mm]."""
        if self.height_step is None:
            raise InvalidInput("height_step is None; heights may have any value")
        number = max(1, math.floor(self.span / self.height_step + 0.5))
        return np.asarray(self.foot + self.height_step * (np.arange(number) + 0.5))

    @property
    def foot(self) -> float:
        """Height of the lowest possible summit above the base plane, offset + min_height [mm]."""
        return self.offset + self.min_height
