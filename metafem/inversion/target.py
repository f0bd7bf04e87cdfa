"""Wanted friction laws, in rescaled load P/E* and friction F/(sigma B) [mm^2]."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import InvalidInput
from metafem.surface import Friction, Material

__all__ = ["BilinearLaw", "LinearLaw", "OperatingPoints", "Target"]


@dataclass(frozen=True, eq=False, init=False)
class OperatingPoints:
    """Points through which the law must pass.

    Parameters
    ----------
    rescaled_load : array_like, (k,)
        P_i/E* [mm^2], positive and increasing.
    rescaled_friction : array_like, (k,)
        F_i/(sigma B) [mm^2], positive and increasing.

    Raises
    ------
    InvalidInput
        For arrays of different length, values that are not finite, and points that do not increase.

    Examples
    --------
    >>> points = OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12])
    >>> len(points.rescaled_load)
    3
    """

    rescaled_load: FloatArray
    rescaled_friction: FloatArray

    def __init__(self, rescaled_load: ArrayLike, rescaled_friction: ArrayLike) -> None:
        load = check.array("rescaled_load", rescaled_load, shape=(None,))
        friction = check.array("rescaled_friction", rescaled_friction, shape=(len(load),))
        object.__setattr__(self, "rescaled_load", check.increasing("rescaled_load", load))
        object.__setattr__(self, "rescaled_friction", check.increasing("rescaled_friction", friction))

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> OperatingPoints:
        """Points from loads P_i and friction forces F_i, both (k,) [N], of a material pair."""
        return cls(*_rescaled(load, friction_force, material, friction))


@dataclass(frozen=True)
class LinearLaw:
    """A straight law: friction proportional to load but for an intercept.

    Parameters
    ----------
    slope : float
        m, slope of rescaled friction over rescaled load [-], positive; ``mu = sigma B / E* m``.

    Examples
    --------
    >>> law = LinearLaw.from_friction_coefficient(1.5, Material(1.36), Friction(0.358, 0.85))
    >>> round(law.slope, 3)
    6.704
    """

    slope: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "slope", check.number("slope", self.slope, above=0.0))

    @classmethod
    def from_friction_coefficient(
        cls, friction_coefficient: float, material: Material, friction: Friction
    ) -> LinearLaw:
        """Law of a friction coefficient mu [-] of a material pair, ``m = mu E* / (sigma B)``."""
        mu = check.number("friction_coefficient", friction_coefficient, above=0.0)
        _check_pair(material, friction)
        return cls(mu * material.composite_modulus / (friction.shear_strength * friction.area_ratio))

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> LinearLaw:
        """Law with the least-squares slope through points P_i, F_i, (k >= 2,) [N]."""
        x, y = _rescaled(load, friction_force, material, friction)
        if len(x) < 2:
            raise InvalidInput(f"load holds {len(x)} value; a slope needs at least 2 points")
        return cls(float(np.polyfit(x, y, 1)[0]))


@dataclass(frozen=True, init=False)
class BilinearLaw:
    """Two straight branches that meet at a crossover load.

    Parameters
    ----------
    slopes : (float, float)
        m_1 below and m_2 above the crossover [-], positive.
    crossover_load : float
        P_c/E* [mm^2], positive.

    Examples
    --------
    >>> BilinearLaw((7.15, 12.52), 0.0380).slopes
    (7.15, 12.52)
    """

    slopes: tuple[float, float]
    crossover_load: float

    def __init__(self, slopes: ArrayLike, crossover_load: float) -> None:
        first, second = check.array("slopes", slopes, shape=(2,))
        pair = tuple(
            check.number(f"slopes[{i}]", value, above=0.0) for i, value in enumerate((first, second))
        )
        object.__setattr__(self, "slopes", pair)
        load = check.number("crossover_load", crossover_load, above=0.0)
        object.__setattr__(self, "crossover_load", load)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> BilinearLaw:
        """Law through three points P_i, F_i, (3,) [N]: on branch one, at the crossover, on branch two."""
        x, y = _rescaled(load, friction_force, material, friction)
        if len(x) != 3:
            raise InvalidInput(f"load holds {len(x)} values; two branches need exactly 3 points")
        return cls(np.diff(y) / np.diff(x), float(x[1]))


Target = OperatingPoints | LinearLaw | BilinearLaw


def _check_pair(material: Material, friction: Friction) -> None:
    check.instance("material", material, Material, "a metafem.Material")
    check.instance("friction", friction, Friction, "a metafem.Friction")


def _rescaled(
    load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
) -> tuple[FloatArray, FloatArray]:
    _check_pair(material, friction)
    newtons = check.increasing("load", check.array("load", load, shape=(None,)))
    force = check.array("friction_force", friction_force, shape=(len(newtons),))
    force = check.increasing("friction_force", force)
    return (
        newtons / material.composite_modulus,
        force / (friction.shear_strength * friction.area_ratio),
    )
