"""Ranges of tools: of radii, and of exponents of power caps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._given import Given
from metafem._validate import FloatArray
from metafem.caps.shapes import STEEPEST
from metafem.errors import refuse_if

# Default spacing of the radii of a range [mm], of the order of the tolerance of ball-end tools.
STEP = 0.01

# Default spacing of the exponents of a range [-].
EXPONENT_STEP = 0.1

# Multiples of a step are rounded to this many decimals, which removes their rounding error.
DECIMALS = 12

# A step may exceed its range by this fraction, which is treated as rounding.
ROUNDING = 1e-9


@dataclass(frozen=True)
class RadiusRange:
    """Range of allowed radii of each asperity.

    Parameters
    ----------
    low, high : float
        Smallest and largest radius [mm], positive and increasing.
    step : float
        Radii between `low` and `high` are multiples of this step [mm]. Default: 0.01, of the order of the
        tolerance of ball-end tools.

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
    step: float = STEP

    def __post_init__(self) -> None:
        check.member(self, "low", above=0.0)
        check.member(self, "high", above=self.low)
        check.member(self, "step", above=0.0)
        _refuse_wide_step(self.step, self.low, self.high)


@dataclass(frozen=True)
class PowerRange:
    """Range of exponents of power caps ``f(rho) = c R (rho/R)^n``.

    All caps of the range have the same depth c R at the distance R from the axis: the larger the exponent,
    the flatter the summit and the steeper the side.

    Parameters
    ----------
    low, high : float
        Smallest and largest exponent n [-], greater than 1, at most 32, and increasing.
    step : float
        Exponents between `low` and `high` are multiples of this step [-]. Default: 0.1.
    radius : float, optional
        R of all caps [mm], positive; default: the common radius of the template.
    coefficient : float
        c of all caps [-], positive; default: 0.5, with which the cap of the exponent 2 is a paraboloid of the
        radius R.

    Raises
    ------
    InvalidInput
        If a value is outside its range, `high` does not exceed `low`, or `step` exceeds ``high - low``.

    Examples
    --------
    >>> PowerRange(1.2, 6).nearest(np.array([1.0, 2.04, 7.0]))
    array([1.2, 2. , 6. ])
    """

    low: float
    high: float
    step: float = EXPONENT_STEP
    radius: float | None = None
    coefficient: float = 0.5

    def __post_init__(self) -> None:
        check.member(self, "low", above=1.0, at_most=STEEPEST)
        check.member(self, "high", above=self.low, at_most=STEEPEST)
        check.member(self, "step", above=0.0)
        check.member(self, "radius", optional=True, above=0.0)
        check.member(self, "coefficient", above=0.0)
        _refuse_wide_step(self.step, self.low, self.high)

    def nearest(self, exponent: FloatArray) -> FloatArray:
        """Return the nearest allowed exponents."""
        return on_steps(exponent, self.low, self.high, self.step)


def on_steps(values: FloatArray, low: float, high: float, step: float | None) -> FloatArray:
    """Return the nearest values from `low` to `high` that are multiples of a step, or an end."""
    if step is not None:
        values = np.round(step * np.rint(values / step), DECIMALS)
    return np.clip(values, low, high)


def _refuse_wide_step(step: float, low: float, high: float) -> None:
    wide = step > (high - low) * (1.0 + ROUNDING)
    words = "exceeds the range from {.number} to {.number}; give a smaller step"
    refuse_if(wide, words, Given("low", low), Given("high", high), key="step", value=step)
