"""Material, friction, dimensions of a block and of a periodic cell."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.errors import InvalidInput, refuse_if

# Members of a Friction.
NAMES = ("shear_strength", "area_ratio")


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


@dataclass(frozen=True, eq=False, repr=False)
class Friction(Value):
    """Friction of the material pair, ``F = sigma B A0``, or of each asperity, ``F = sum sigma_i B_i A_i``.

    Asperities differ in friction if they have different coatings. Rescaled friction is by one `stress` for
    all asperities, by default the largest sigma B: ``F/stress = sum w_i A_i`` with the weights
    ``w_i = sigma_i B_i/stress``. It is A0 if sigma B is this stress for all asperities.

    Parameters
    ----------
    shear_strength : float or array_like, (n,)
        sigma [MPa], positive: friction force over the real contact area under shear, one value for all
        asperities or one for each.
    area_ratio : float or array_like, (n,)
        B [-], positive: real contact area under shear over that before shear, one value or one for each;
        default: 1, no change.
    reference : float, optional
        Stress [MPa] by which friction is rescaled, positive; default: the largest sigma B. A design whose
        tools have coatings has here the sigma B of its template, by which its target is rescaled.

    Raises
    ------
    InvalidInput
        If a value is not positive, or the two arrays differ in length.

    Examples
    --------
    >>> Friction(shear_strength=0.404, area_ratio=0.85).shear_strength
    0.404
    >>> coated = Friction(shear_strength=[0.4, 0.1], area_ratio=0.85)
    >>> round(coated.stress, 12), coated.weights
    (0.34, array([1.  , 0.25]))
    """

    shear_strength: float | FloatArray
    area_ratio: float | FloatArray = 1.0
    reference: float | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        check.member(self, "reference", optional=True, above=0.0)
        for name in NAMES:
            if check.scalar(getattr(self, name)):
                check.member(self, name, above=0.0)
            else:
                values = check.array(name, getattr(self, name), shape=(None,), positive=True)
                object.__setattr__(self, name, values)
        counts = {len(values) for values in self._arrays().values()}
        refuse_if(
            len(counts) > 1,
            f"and shear_strength have {' and '.join(map(str, sorted(counts)))} values; both must have one "
            "for each asperity, or one for all",
            key="area_ratio",
        )

    @property
    def stress(self) -> float:
        """Reference or largest sigma B [MPa]: the friction force over the rescaled friction."""
        return float(np.max(self._each())) if self.reference is None else self.reference

    @property
    def weights(self) -> float | FloatArray:
        """sigma_i B_i over `stress` [-], (n,); 1.0 if it is the same for all asperities and is `stress`."""
        each = np.asarray(self._each())
        return 1.0 if (each == self.stress).all() else np.asarray(each / self.stress)

    @property
    def differs(self) -> bool:
        """Whether sigma B differs from asperity to asperity, or from the reference."""
        return np.ndim(self.weights) > 0

    def coated(self, shear_strength: FloatArray) -> Friction:
        """Return the friction of asperities with other sigma (n,) [MPa], rescaled as this friction."""
        return replace(self, shear_strength=shear_strength, reference=self.stress)

    def at(self, some: Any) -> Friction:
        """Return the friction of some asperities (indices or mask)."""
        arrays = self._arrays()
        return replace(self, **{name: values[some] for name, values in arrays.items()}) if arrays else self

    def refuse_differing(self, what: str) -> None:
        """Raise InvalidInput if a member has one value for each asperity, which `what` does not support."""
        for name in self._arrays():
            raise InvalidInput(
                f"has one value for each asperity, which {what} does not support; use one for all",
                key=f"friction.{name}",
            )

    def of(self, count: int) -> Friction:
        """Return the friction of `count` asperities, with one value for all where their values are equal.

        If sigma B differs from the reference, sigma has one value for each asperity.
        """
        changes: dict[str, Any] = {}
        for name, values in self._arrays().items():
            refuse_if(
                len(values) != count,
                f"has {len(values)} values for {count} asperities; it must be one value, or one for each",
                key=f"friction.{name}",
            )
            if (values == values[0]).all():
                changes[name] = float(values[0])
        found = replace(self, **changes) if changes else self
        if self.reference is None or found._arrays():
            return found
        if found.shear_strength * found.area_ratio == self.reference:
            return replace(found, reference=None)
        return replace(found, shear_strength=np.full(count, found.shear_strength))

    def _each(self) -> float | FloatArray:
        return self.shear_strength * self.area_ratio

    def _arrays(self) -> dict[str, FloatArray]:
        """Return the members with one value for each asperity."""
        members = {name: getattr(self, name) for name in NAMES}
        return {name: values for name, values in members.items() if isinstance(values, np.ndarray)}


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
