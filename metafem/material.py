"""Material, friction, dimensions of a block and of a periodic cell."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.errors import refuse_if

# Range of E* [MPa] of rubbers and gels; outside it, a unit is usually wrong.
ELASTOMERS = (0.01, 100.0)


@dataclass(frozen=True)
class Material:
    """Linear-elastic material of the block; the plane is rigid.

    The composite modulus is ``E* = E / (1 - nu^2)``.

    Parameters
    ----------
    composite_modulus : float
        E* [MPa], positive.
    poisson_ratio : float
        nu [-], from 0 to 0.5 (incompressible); default: 0.5.

    Raises
    ------
    InvalidInput
        If a value is outside its range.

    Examples
    --------
    >>> Material(composite_modulus=1.36, poisson_ratio=0.5).young_modulus
    1.02
    """

    composite_modulus: float
    poisson_ratio: float = 0.5

    def __post_init__(self) -> None:
        check.member(self, "composite_modulus", above=0.0)
        check.member(self, "poisson_ratio", **check.POISSON)

    @classmethod
    def from_young(cls, young_modulus: float, poisson_ratio: float = 0.5) -> Material:
        """Return the material with the given Young's modulus, ``E* = E / (1 - nu^2)``.

        Parameters
        ----------
        young_modulus : float
            E [MPa], positive.
        poisson_ratio : float
            nu [-], from 0 to 0.5; default: 0.5.

        Returns
        -------
        Material

        Raises
        ------
        InvalidInput
            If a value is outside its range.

        Examples
        --------
        >>> Material.from_young(young_modulus=1.02, poisson_ratio=0.5)
        Material(composite_modulus=1.36, poisson_ratio=0.5)
        """
        modulus = check.number("young_modulus", young_modulus, above=0.0)
        ratio = check.number("poisson_ratio", poisson_ratio, **check.POISSON)
        return cls(modulus / (1.0 - ratio**2), ratio)

    @property
    def young_modulus(self) -> float:
        """Young's modulus E = E* (1 - nu^2) [MPa]."""
        return self.composite_modulus * (1.0 - self.poisson_ratio**2)


@dataclass(frozen=True)
class Friction:
    """Friction of the material pair, ``F = sigma B A0``.

    Parameters
    ----------
    shear_strength : float
        sigma [MPa], positive: friction force over the real contact area under shear.
    area_ratio : float
        B [-], positive and at most 1: real contact area under shear over that before shear; default: 1, no
        change.

    Raises
    ------
    InvalidInput
        If a value is outside its range.

    Examples
    --------
    >>> friction = Friction(shear_strength=0.404, area_ratio=0.85)
    >>> round(friction.stress, 4)
    0.3434
    """

    shear_strength: float
    area_ratio: float = 1.0

    def __post_init__(self) -> None:
        check.member(self, "shear_strength", above=0.0)
        check.member(self, "area_ratio", above=0.0)
        refuse_if(
            self.area_ratio > 1.0,
            "must be at most 1, because contacts shrink under shear; 85 percent is 0.85",
            key="area_ratio",
            value=self.area_ratio,
        )

    @property
    def stress(self) -> float:
        """sigma B [MPa]: the friction force over the rescaled friction."""
        return self.shear_strength * self.area_ratio


@dataclass(frozen=True)
class Block:
    """Block below the asperities, centred on the origin, with a bonded base.

    Parameters
    ----------
    width, length, thickness : float
        Extent along x, along y and below the base plane [mm], positive.

    Raises
    ------
    InvalidInput
        If a value is not positive.

    Examples
    --------
    >>> Block(width=20.0, length=20.0, thickness=7.2).thickness
    7.2
    """

    width: float
    length: float
    thickness: float

    def __post_init__(self) -> None:
        for name in ("width", "length", "thickness"):
            check.member(self, name, above=0.0)


@dataclass(frozen=True)
class PeriodicCell:
    """One period of a surface that repeats along x and y without end.

    Each asperity stands for one in every period, and all loads and areas are those of one cell. Models that
    interact sum the displacements of all periods. On a half-space the mean of this sum diverges; it is left
    out, so that the separation is measured from the mean plane of the deformed surface. On a bonded layer the
    sum converges, and the separation is measured from the undeformed base plane, as without a cell.

    The cell has no origin: only the extent of the positions is limited. Distances along x that differ by a
    multiple of `width`, or along y by a multiple of `length`, are equal.

    Parameters
    ----------
    width, length : float
        Period along x and along y [mm], positive.

    Raises
    ------
    InvalidInput
        If a value is not positive.

    Examples
    --------
    >>> from metafem import HalfSpace, Interacting, Surface, equilibrium
    >>> cell = PeriodicCell(width=1.5, length=1.5)
    >>> surface = Surface([[0, 0]], [0.1], 0.526, Material(1.36), cell=cell)
    >>> state = equilibrium(surface, Interacting(), load=0.01)
    >>> mean_pressure = state.load / cell.area
    >>> round(mean_pressure, 5)
    0.00444
    """

    width: float
    length: float

    def __post_init__(self) -> None:
        for name in ("width", "length"):
            check.member(self, name, above=0.0)

    @property
    def area(self) -> float:
        """Nominal area of one period [mm^2]."""
        return self.width * self.length

    def nearest(self, x: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return differences of positions [mm] to the nearest period, at most half a side each."""
        return x - self.width * np.rint(x / self.width), y - self.length * np.rint(y / self.length)
