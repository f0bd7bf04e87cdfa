"""Units of the values of a target, for titles and messages."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.surface import Friction, Material

LoadRange = tuple[float, float]

# Digits of a friction coefficient or force after conversion to its rescaled value and back: input numbers
# with up to this many digits are reproduced.
DIGITS = 15

# Digits of a bound in a message.
BOUND_DIGITS = 4


@dataclass(frozen=True)
class Wording:
    """Units of a target's values: rescaled loads, frictions and slopes, or newtons and coefficients.

    Examples
    --------
    >>> Wording().slopes(6.87), Wording(1.36, 0.3043).slopes(6.25698)
    ('slope 6.87', 'friction coefficient 1.4')
    """

    composite_modulus: float | None = None  # E* [MPa]; if set, loads are stated in newtons
    # sigma B, the friction force per initial real contact area [MPa]; with it friction is stated in newtons.
    # With both, slopes are stated as friction coefficients ``mu = sigma B / E* m``
    shear_stress: float | None = None
    # E* [MPa] of the part; with it loads are also stated in the other unit
    part_modulus: float | None = None

    def __post_init__(self) -> None:
        for name in ("composite_modulus", "shear_stress", "part_modulus"):
            check.member(self, name, optional=True, above=0.0)

    @classmethod
    def of(cls, material: Material, friction: Friction) -> Wording:
        """Newtons and friction coefficients of a material pair."""
        check.instance("material", material, Material, "a metafem.Material")
        check.instance("friction", friction, Friction, "a metafem.Friction")
        return cls(material.composite_modulus, friction.shear_strength * friction.area_ratio)

    @property
    def per_slope(self) -> float | None:
        """Friction coefficient of the slope 1, ``sigma B / E*``; None if slopes are stated as such."""
        if self.composite_modulus is None or self.shear_stress is None:
            return None
        return self.shear_stress / self.composite_modulus

    @property
    def keys(self) -> tuple[str, str]:
        """Key of one slope, and of several."""
        if self.per_slope is None:
            return "slope", "slopes"
        return "friction_coefficient", "friction_coefficients"

    def name(self, count: int = 1) -> str:
        """Return the name of one slope, or of several, in a sentence."""
        return self.keys[count > 1].replace("_", " ")

    def slope(self, coefficient: float) -> float:
        """Return the slope of a value as given: the inverse of `coefficient`."""
        return coefficient / (self.per_slope or 1.0)

    def from_newtons(self, load: float) -> float:
        """Return P/E* [mm^2] of a load [N]."""
        return load / (self.composite_modulus or 1.0)

    def range_from_newtons(self, load_range: ArrayLike | None) -> LoadRange | None:
        """Return a checked range of P/E* [mm^2] from a range of loads [N]."""
        if load_range is None:
            return None
        low, high = check.interval("load_range_N", load_range)
        return self.from_newtons(low), self.from_newtons(high)

    def coefficient(self, slope: float) -> float:
        """Return a slope in the unit of the target: as a slope, or as a friction coefficient."""
        return _digits(slope * (self.per_slope or 1.0), DIGITS)

    def coefficients(self, slopes: tuple[float, ...]) -> tuple[float, ...] | None:
        """Return the friction coefficients of slopes; None if slopes are stated as such."""
        return None if self.per_slope is None else tuple(self.coefficient(slope) for slope in slopes)

    def given_slopes(self, friction_coefficients: ArrayLike, count: int | None) -> list[float]:
        """Return the slopes of checked friction coefficients, (count,)."""
        values = check.array("friction_coefficients", friction_coefficients, shape=(count,))
        return [
            self.slope(check.number(f"friction_coefficients[{i}]", mu, above=0.0))
            for i, mu in enumerate(values.tolist())
        ]

    def slopes(self, *slopes: float) -> str:
        """Return slopes in words: ``slopes 6 and 9``."""
        return f"{self.name(len(slopes))} {_listed([f'{self.coefficient(slope):.6g}' for slope in slopes])}"

    def slope_bound(self, slope: float, *, up: bool) -> str:
        """Return a bound on slopes as text, rounded to the reachable side."""
        return f"{_rounded(self.coefficient(slope), up, None):.6g}"

    def of_part(self, material: Material) -> Wording:
        """Return the wording that also states loads in the other unit for a part of a material."""
        return replace(self, part_modulus=material.composite_modulus)

    def title_loads(self, *loads: float) -> str:
        """Return rescaled loads in words for a title, in the unit of the target: ``0.05 to 0.2 mm²``."""
        return _stated(loads, self.composite_modulus).replace("^2", "²")

    def loads(self, *loads: float) -> str:
        """Return rescaled loads in words: ``0.05 to 0.2 mm^2``, or ``0.068 N (0.05 mm^2)``."""
        return self._in_both(lambda factor: _stated(loads, factor))

    def load_bound(self, load: float, *, up: bool) -> str:
        """Return a bound on loads in words, rounded to the reachable side."""
        return self._in_both(lambda factor: _stated((_rounded(load, up, factor),), factor))

    def inside(self, low: float, high: float) -> str:
        """Return a range of loads in words, rounded to lie within the given one."""
        return self._in_both(
            lambda factor: _stated((_rounded(low, True, factor), _rounded(high, False, factor)), factor)
        )

    def _in_both(self, words: Callable[[float | None], str]) -> str:
        """Return loads in the unit of the target, and in brackets in the other one where E* is known.

        `words` is a function of E*, or of None for mm^2.
        """
        if self.composite_modulus is not None:
            return f"{words(self.composite_modulus)} ({words(None)})"
        return words(None) + (f" ({words(self.part_modulus)})" if self.part_modulus else "")

    def frictions(self, *frictions: float) -> str:
        """Return rescaled frictions in words: ``0.84 to 1.68 mm^2``."""
        return _stated(frictions, self.shear_stress)

    def rescaled(
        self,
        load: ArrayLike,
        friction_force: ArrayLike,
        use: str = "a law",
        least: int = 1,
        rising: bool = True,
    ) -> tuple[FloatArray, FloatArray]:
        """Return P/E* and F/(sigma B) of increasing loads and friction forces [N], at least so many.

        Where `rising` is false the friction forces need not increase.
        """
        newtons = check.increasing("load", check.array("load", load, shape=(None,)))
        if len(newtons) < least:
            words = f"holds {len(newtons)} value; {use} needs at least {least} points"
            raise InvalidInput(words, key="load")
        force = check.array("friction_force", friction_force, shape=(len(newtons),), positive=not rising)
        force = check.increasing("friction_force", force) if rising else force
        return newtons / (self.composite_modulus or 1.0), force / (self.shear_stress or 1.0)


# The default: rescaled values.
RESCALED = Wording()


@dataclass(frozen=True)
class Message:
    """A sentence with numbers whose units are inserted when it is displayed.

    Its parts are texts, other messages, and tuples: the name of a `Wording` method with the rescaled values
    that it states.

    Examples
    --------
    >>> message = Message(("up to ", ("loads", 0.2)))
    >>> str(message), message.worded(Wording(composite_modulus=1.5))
    ('up to 0.2 mm^2', 'up to 0.3 N (0.2 mm^2)')
    """

    parts: Sequence[Any]
    wording: Wording = RESCALED

    def __str__(self) -> str:
        return self.worded(None)

    def worded(self, wording: Wording | None) -> str:
        """Return the sentence in the units of a wording; default: its own."""
        units = replace(wording or self.wording, part_modulus=self.wording.part_modulus)

        def words(part: Any) -> str:
            if isinstance(part, Message):
                return part.worded(wording)
            return str(getattr(units, part[0])(*part[1:])) if isinstance(part, tuple) else part

        return "".join(map(words, self.parts))


def _digits(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


def _stated(values: tuple[float, ...], factor: float | None) -> str:
    """Return rescaled values in mm^2, or times a factor in N."""
    digits = (f"{_digits((factor or 1.0) * value, DIGITS):.6g}" for value in values)
    return f"{' to '.join(digits)} {'mm^2' if factor is None else 'N'}"


def _rounded(given: float, up: bool, factor: float | None) -> float:
    """Return a positive number rounded up or down such that it has few digits times a factor."""
    value = (factor or 1.0) * given
    near = _digits(value, BOUND_DIGITS)
    if not ((near >= value) if up else (near <= value)):
        step = 10.0 ** (math.floor(math.log10(value)) - BOUND_DIGITS + 1)
        near = _digits(near + (step if up else -step), BOUND_DIGITS)
    return near / (factor or 1.0)


def _listed(words: list[str]) -> str:
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
