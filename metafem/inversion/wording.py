"""Units in which titles and messages state the values of a target."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.surface import Friction, Material

LoadRange = tuple[float, float]

# Converted values are rounded to this many digits. A friction coefficient or force with up to this many
# digits is then reproduced after conversion to its rescaled value and back.
DIGITS = 15

# Number of digits of a bound in a message.
BOUND_DIGITS = 4


@dataclass(frozen=True)
class Wording:
    """Units of a target: rescaled loads, frictions and slopes, or forces in N and friction coefficients.

    Examples
    --------
    >>> Wording().slopes(6.87), Wording(1.36, 0.3043).slopes(6.25698)
    ('slope 6.87', 'friction coefficient 1.4')
    """

    composite_modulus: float | None = None  # E* [MPa]; if set, loads are stated in newtons
    # sigma B, the friction force per initial real contact area [MPa]; if set, friction is stated in newtons.
    # If E* is also set, slopes are stated as friction coefficients ``mu = sigma B / E* m``
    shear_stress: float | None = None
    # E* [MPa] of the part; if set, loads are stated both in mm^2 and in newtons
    part_modulus: float | None = None

    def __post_init__(self) -> None:
        for name in ("composite_modulus", "shear_stress", "part_modulus"):
            check.member(self, name, optional=True, above=0.0)

    @classmethod
    def of(cls, material: Material, friction: Friction) -> Wording:
        """Return the wording in newtons and friction coefficients for a material pair."""
        check.instance("material", material, Material, "a metafem.Material")
        check.instance("friction", friction, Friction, "a metafem.Friction")
        return cls(material.composite_modulus, friction.stress)

    def of_part(self, material: Material) -> Wording:
        """Return the wording that states loads both in mm^2 and in newtons, for a part made of a material."""
        return replace(self, part_modulus=material.composite_modulus)

    @property
    def per_slope(self) -> float | None:
        """Friction coefficient per unit slope, ``sigma B / E*`` [-]; None if slopes are not converted."""
        if self.composite_modulus is None or self.shear_stress is None:
            return None
        return self.shear_stress / self.composite_modulus

    @property
    def keys(self) -> tuple[str, str]:
        """Key for one slope, and key for several slopes."""
        if self.per_slope is None:
            return "slope", "slopes"
        return "friction_coefficient", "friction_coefficients"

    def name(self, count: int = 1) -> str:
        """Return the name of `count` slopes for use in a sentence."""
        return self.keys[count > 1].replace("_", " ")

    def slope(self, coefficient: float) -> float:
        """Return the slope [-] for a value in the unit of the target, the inverse of `coefficient`."""
        return coefficient / (self.per_slope or 1.0)

    def from_newtons(self, load: float) -> float:
        """Return P/E* [mm^2] for a load P [N]."""
        return load / (self.composite_modulus or 1.0)

    def range_from_newtons(self, load_range: ArrayLike | None) -> LoadRange | None:
        """Return a checked range of P/E* [mm^2] from a range of loads [N]."""
        if load_range is None:
            return None
        low, high = check.interval("load_range_N", load_range)
        return self.from_newtons(low), self.from_newtons(high)

    def coefficient(self, slope: float) -> float:
        """Return a slope in the unit of the target, either unchanged or as a friction coefficient [-]."""
        return _digits(slope * (self.per_slope or 1.0), DIGITS)

    def coefficients(self, slopes: tuple[float, ...]) -> tuple[float, ...] | None:
        """Return slopes as friction coefficients [-]; None if slopes are not converted."""
        return None if self.per_slope is None else tuple(self.coefficient(slope) for slope in slopes)

    def given_slopes(self, friction_coefficients: ArrayLike, count: int | None) -> list[float]:
        """Return the slopes [-] of friction coefficients [-] after a check, (count,)."""
        values = check.array("friction_coefficients", friction_coefficients, shape=(count,))
        return [
            self.slope(check.number(f"friction_coefficients[{i}]", mu, above=0.0))
            for i, mu in enumerate(values.tolist())
        ]

    def rescaled(
        self,
        load: ArrayLike,
        friction_force: ArrayLike,
        use: str = "a law",
        least: int = 1,
        rising: bool = True,
    ) -> tuple[FloatArray, FloatArray]:
        """Return P/E* and F/(sigma B), both (k,) [mm^2], for loads and friction forces, both (k,) [N].

        The loads must increase, and so must the friction forces if `rising` is true. There must be at least
        `least` points.
        """
        newtons = check.increasing("load", check.array("load", load, shape=(None,)))
        if len(newtons) < least:
            words = f"holds {len(newtons)} value; {use} needs at least {least} points"
            raise InvalidInput(words, key="load")
        force = check.array("friction_force", friction_force, shape=(len(newtons),), positive=not rising)
        force = check.increasing("friction_force", force) if rising else force
        return newtons / (self.composite_modulus or 1.0), force / (self.shear_stress or 1.0)

    def slopes(self, *slopes: float) -> str:
        """Return slopes in words: ``slopes 6 and 9``."""
        return f"{self.name(len(slopes))} {listed([f'{self.coefficient(slope):.6g}' for slope in slopes])}"

    def slope_bound(self, slope: float, *, up: bool) -> str:
        """Return a bound on slopes as text; `up` rounds it up, otherwise down, so that it is reachable."""
        return f"{_rounded(self.coefficient(slope), up, None):.6g}"

    def title_loads(self, *loads: float) -> str:
        """Return rescaled loads in words for a title, in the unit of the target: ``0.05 to 0.2 mm²``."""
        return _stated(loads, self.composite_modulus).replace("^2", "²")

    def loads(self, *loads: float) -> str:
        """Return rescaled loads in words: ``0.05 to 0.2 mm^2``, or ``0.068 N (0.05 mm^2)``."""
        return self._in_both(lambda factor: _stated(loads, factor))

    def inside(self, low: float, high: float) -> str:
        """Return a range of loads in words, with its ends rounded inwards."""
        return self._in_both(
            lambda factor: _stated((_rounded(low, True, factor), _rounded(high, False, factor)), factor)
        )

    def _in_both(self, words: Callable[[float | None], str]) -> str:
        """Return loads in the unit of the target, followed by the other unit in brackets if E* is known.

        `words` maps E* [MPa] to the loads in newtons, and None to the loads in mm^2.
        """
        if self.composite_modulus is not None:
            return f"{words(self.composite_modulus)} ({words(None)})"
        return words(None) + (f" ({words(self.part_modulus)})" if self.part_modulus else "")

    def frictions(self, *frictions: float) -> str:
        """Return rescaled frictions in words: ``0.84 to 1.68 mm^2``."""
        return _stated(frictions, self.shear_stress)


# Default wording: rescaled values.
RESCALED = Wording()


def _digits(value: float, digits: int) -> float:
    return float(f"{value:.{digits}g}")


def _stated(values: tuple[float, ...], factor: float | None) -> str:
    """Return rescaled values in words: in mm^2, or multiplied by a factor [MPa] in N."""
    digits = (f"{_digits((factor or 1.0) * value, DIGITS):.6g}" for value in values)
    return f"{' to '.join(digits)} {'mm^2' if factor is None else 'N'}"


def _rounded(given: float, up: bool, factor: float | None) -> float:
    """Return a positive number rounded up or down so that its product with a factor has few digits."""
    value = (factor or 1.0) * given
    near = _digits(value, BOUND_DIGITS)
    if not ((near >= value) if up else (near <= value)):
        step = 10.0 ** (math.floor(math.log10(value)) - BOUND_DIGITS + 1)
        near = _digits(near + (step if up else -step), BOUND_DIGITS)
    return near / (factor or 1.0)


def listed(words: list[str]) -> str:
    """Return words as a list in a sentence: ``a, b and c``."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
