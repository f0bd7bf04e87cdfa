"""Material, friction and dimensions of a block."""

from __future__ import annotations

from dataclasses import dataclass

from metafem import _validate as check


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
        B [-], positive: real contact area under shear over that before shear; default: 1, no change.

    Raises
    ------
    InvalidInput
        If a value is not positive.

    Examples
    --------
    >>> Friction(shear_strength=0.404, area_ratio=0.85).shear_strength
    0.404
    """

    shear_strength: float
    area_ratio: float = 1.0

    def __post_init__(self) -> None:
        check.member(self, "shear_strength", above=0.0)
        check.member(self, "area_ratio", above=0.0)


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
