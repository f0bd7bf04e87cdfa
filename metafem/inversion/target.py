"""Wanted friction laws, in rescaled load P/E* and friction F/(sigma B) [mm^2]."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.errors import InvalidInput
from metafem.surface import Friction, Material

__all__ = [
    "BilinearLaw",
    "LinearLaw",
    "MultilinearLaw",
    "OperatingPoints",
    "PowerLaw",
    "SampledLaw",
    "Target",
]


@dataclass(frozen=True, eq=False, init=False, repr=False)
class OperatingPoints(Value):
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
    through_origin : bool
        Whether there is to be no intercept: friction in true proportion to the load, over the widest
        range of loads that the asperities allow, instead of heights from an exponential density.

    Examples
    --------
    >>> law = LinearLaw.from_friction_coefficient(1.5, Material(1.36), Friction(0.358, 0.85))
    >>> round(law.slope, 3)
    6.704
    """

    slope: float
    through_origin: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "slope", check.number("slope", self.slope, above=0.0))
        if not isinstance(self.through_origin, bool):
            raise InvalidInput(f"through_origin = {self.through_origin!r} must be True or False")

    @classmethod
    def from_friction_coefficient(
        cls,
        friction_coefficient: float,
        material: Material,
        friction: Friction,
        through_origin: bool = False,
    ) -> LinearLaw:
        """Law of a friction coefficient mu [-] of a material pair, ``m = mu E* / (sigma B)``."""
        mu = check.number("friction_coefficient", friction_coefficient, above=0.0)
        _check_pair(material, friction)
        slope = mu * material.composite_modulus / (friction.shear_strength * friction.area_ratio)
        return cls(slope, through_origin)

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


@dataclass(frozen=True, eq=False, init=False, repr=False)
class SampledLaw(Value):
    """A law given by samples, to be met in the least-squares sense of the relative differences.

    Parameters
    ----------
    rescaled_load : array_like, (k,)
        P/E* [mm^2], positive and increasing.
    rescaled_friction : array_like, (k,)
        F/(sigma B) [mm^2], positive and increasing.
    weight : array_like, (k,), optional
        Positive weights of the squared relative differences; equal unless given.

    Examples
    --------
    >>> law = SampledLaw([0.1, 0.2, 0.3], [0.9, 1.6, 2.2])
    >>> law.weight
    array([1., 1., 1.])
    """

    rescaled_load: FloatArray
    rescaled_friction: FloatArray
    weight: FloatArray

    def __init__(
        self, rescaled_load: ArrayLike, rescaled_friction: ArrayLike, weight: ArrayLike | None = None
    ) -> None:
        points = OperatingPoints(rescaled_load, rescaled_friction)
        count = len(points.rescaled_load)
        weights = check.array("weight", np.ones(count) if weight is None else weight, shape=(count,))
        if weights.min() <= 0.0:
            i = int(weights.argmin())
            raise InvalidInput(f"weight[{i}] = {weights[i]:g} must be greater than 0")
        object.__setattr__(self, "rescaled_load", points.rescaled_load)
        object.__setattr__(self, "rescaled_friction", points.rescaled_friction)
        object.__setattr__(self, "weight", weights)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> SampledLaw:
        """Samples from loads P and friction forces F, both (k,) [N], of a material pair."""
        return cls(*_rescaled(load, friction_force, material, friction))


@dataclass(frozen=True, init=False)
class PowerLaw:
    """Friction proportional to a power of the load over a range, ``F/(sigma B) = C (P/E*)^beta``.

    Parameters
    ----------
    exponent : float
        beta [-], positive; no surface of equal radii has one below 2/3.
    load_range : (float, float)
        P/E* from and to [mm^2], positive and increasing.
    prefactor : float, optional
        C [mm^(2 - 2 beta)], positive; free unless given.

    Examples
    --------
    >>> PowerLaw(1.2, (0.1, 0.4)).prefactor is None
    True
    """

    exponent: float
    load_range: tuple[float, float]
    prefactor: float | None

    def __init__(self, exponent: float, load_range: ArrayLike, prefactor: float | None = None) -> None:
        object.__setattr__(self, "exponent", check.number("exponent", exponent, above=0.0))
        object.__setattr__(self, "load_range", _range("load_range", load_range))
        value = None if prefactor is None else check.number("prefactor", prefactor, above=0.0)
        object.__setattr__(self, "prefactor", value)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> PowerLaw:
        """Law with the least-squares exponent and prefactor through points P, F, (k >= 2,) [N]."""
        x, y = _rescaled(load, friction_force, material, friction)
        if len(x) < 2:
            raise InvalidInput(f"load holds {len(x)} value; an exponent needs at least 2 points")
        exponent, height = np.polyfit(np.log(x), np.log(y), 1)
        return cls(float(exponent), (float(x[0]), float(x[-1])), float(np.exp(height)))


@dataclass(frozen=True, init=False)
class MultilinearLaw:
    """Straight branches of given slopes, one after the other, with a free intercept.

    Parameters
    ----------
    slopes : array_like, (b,)
        Slopes of the branches [-], positive, rising or falling.
    crossover_loads : sequence, (b - 1,)
        Where each branch gives way to the next [mm^2]: one load P/E*, at which they meet, or a pair
        (end of the branch, start of the next) between which the law is free, as is then the intercept
        of the next branch. Increasing.
    load_range : (float, float)
        P/E* from the start of the first to the end of the last branch [mm^2].

    Examples
    --------
    >>> law = MultilinearLaw([9.5, 7.0], [(0.07, 0.18)], (0.03, 0.26))
    >>> law.branches
    ((9.5, (0.03, 0.07)), (7.0, (0.18, 0.26)))
    """

    slopes: tuple[float, ...]
    crossover_loads: tuple[tuple[float, float], ...]
    load_range: tuple[float, float]

    def __init__(self, slopes: ArrayLike, crossover_loads: Sequence[object], load_range: ArrayLike) -> None:
        values = check.array("slopes", slopes, shape=(None,))
        if values.min() <= 0.0:
            raise InvalidInput(f"slopes holds {values.min():g}; all must be greater than 0")
        listed = isinstance(crossover_loads, (list, tuple, np.ndarray))
        if not listed or len(crossover_loads) != len(values) - 1:
            raise InvalidInput(
                f"crossover_loads = {crossover_loads!r:.60} must hold {len(values) - 1} loads or pairs of "
                f"loads for {len(values)} slopes"
            )
        ends = _range("load_range", load_range)
        pairs = tuple(_crossover(i, given) for i, given in enumerate(crossover_loads))
        path = [ends[0], *(load for pair in pairs for load in pair), ends[1]]
        for i in range(0, len(path), 2):
            if not path[i] < path[i + 1]:
                raise InvalidInput(
                    f"branch {i // 2 + 1} would run from {path[i]:g} to {path[i + 1]:g} mm^2; "
                    "crossover_loads must increase within load_range"
                )
        object.__setattr__(self, "slopes", tuple(values.tolist()))
        object.__setattr__(self, "crossover_loads", pairs)
        object.__setattr__(self, "load_range", ends)

    @property
    def branches(self) -> tuple[tuple[float, tuple[float, float]], ...]:
        """Slope and load range of each branch."""
        path = [
            self.load_range[0],
            *(load for pair in self.crossover_loads for load in pair),
            self.load_range[1],
        ]
        return tuple((m, (path[2 * i], path[2 * i + 1])) for i, m in enumerate(self.slopes))

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> MultilinearLaw:
        """Law of the slopes of the straight lines between points P, F, (b + 1,) [N]."""
        x, y = _rescaled(load, friction_force, material, friction)
        if len(x) < 2:
            raise InvalidInput(f"load holds {len(x)} value; a branch needs 2 points")
        return cls(np.diff(y) / np.diff(x), x[1:-1].tolist(), (float(x[0]), float(x[-1])))


Target = OperatingPoints | LinearLaw | BilinearLaw | SampledLaw | PowerLaw | MultilinearLaw


def _range(name: str, given: ArrayLike) -> tuple[float, float]:
    low, high = check.increasing(name, check.array(name, given, shape=(2,)))
    return float(low), float(high)


def _crossover(i: int, given: object) -> tuple[float, float]:
    name = f"crossover_loads[{i}]"
    if check.scalar(given):
        load = check.number(name, given, above=0.0)
        return load, load
    if not isinstance(given, (list, tuple, np.ndarray)) or not all(check.scalar(end) for end in given):
        raise InvalidInput(f"{name} = {given!r:.60} must be a load or a pair of loads [mm^2]")
    return _range(name, given)


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
