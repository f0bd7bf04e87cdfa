"""Units in which titles and messages state the values of a target."""

from __future__ import annotations

from dataclasses import dataclass, replace

from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if
from metafem.surface import Friction, Material

LoadRange = tuple[float, float]


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

    def name(self, count: int = 1) -> str:
        """Return the name of `count` slopes for use in a sentence."""
        return ("slope" if self.per_slope is None else "friction coefficient") + "s" * (count > 1)

    def coefficient(self, slope: float) -> float:
        """Return a slope as a friction coefficient [-], to 15 digits, if the target states slopes so."""
        return float(f"{slope * (self.per_slope or 1.0):.15g}")

    def given_slopes(self, friction_coefficients: ArrayLike, count: int | None) -> list[float]:
        """Return the slopes [-] of friction coefficients [-] after a check, (count,)."""
        values = check.array("friction_coefficients", friction_coefficients, shape=(count,), positive=True)
        return [mu / (self.per_slope or 1.0) for mu in values.tolist()]

    def rescaled(
        self, load: ArrayLike, friction_force: ArrayLike, least: int = 1, rising: bool = True
    ) -> tuple[FloatArray, FloatArray]:
        """Return P/E* and F/(sigma B), both (k,) [mm^2], for loads and friction forces, both (k,) [N].

        The loads must increase, and so must the friction forces if `rising` is true. There must be at least
        `least` points.
        """
        newtons = check.increasing("load", check.array("load", load, shape=(None,)))
        few = f"holds {len(newtons)} value; at least {least} points are needed"
        refuse_if(len(newtons) < least, few, key="load")
        force = check.array("friction_force", friction_force, shape=newtons.shape, positive=not rising)
        force = check.increasing("friction_force", force) if rising else force
        return newtons / (self.composite_modulus or 1.0), force / (self.shear_stress or 1.0)

    def slopes(self, *slopes: float) -> str:
        """Return slopes in words: ``slopes 6 and 9``."""
        return f"{self.name(len(slopes))} {listed([f'{self.coefficient(slope):.6g}' for slope in slopes])}"

    def title_loads(self, *loads: float) -> str:
        """Return rescaled loads in words for a title, in the unit of the target: ``0.05 to 0.2 mm²``."""
        return _stated(loads, self.composite_modulus).replace("^2", "²")

    def loads(self, *loads: float, digits: int = 6) -> str:
        """Return rescaled loads in words: ``0.05 to 0.2 mm^2``, or ``0.068 N (0.05 mm^2)``."""
        modulus = self.composite_modulus or self.part_modulus
        if modulus is None:
            return _stated(loads, digits=digits)
        both = _stated(loads, digits=digits), _stated(loads, modulus, digits)
        first, second = both if self.composite_modulus is None else both[::-1]
        return f"{first} ({second})"

    def frictions(self, *frictions: float) -> str:
        """Return rescaled frictions in words: ``0.84 to 1.68 mm^2``."""
        return _stated(frictions, self.shear_stress)


# Default wording: rescaled values.
RESCALED = Wording()


def _stated(values: tuple[float, ...], factor: float | None = None, digits: int = 6) -> str:
    """Return rescaled values in words: in mm^2, or multiplied by a factor [MPa] in N."""
    numbers = " to ".join(f"{(factor or 1.0) * value:.{digits}g}" for value in values)
    return f"{numbers} {'mm^2' if factor is None else 'N'}"


def listed(words: list[str]) -> str:
    """Return words as a list in a sentence: ``a, b and c``."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
