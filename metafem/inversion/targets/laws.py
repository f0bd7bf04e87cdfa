"""Target friction laws, in rescaled load P/E* and friction F/(sigma B) [mm^2]."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._calls import checked_class
from metafem._validate import FloatArray
from metafem._values import Value
from metafem.errors import InvalidInput
from metafem.inversion.targets.straight import BilinearLaw, LinearLaw, MultilinearLaw
from metafem.inversion.targets.wording import RESCALED, Wording, in_title
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


@checked_class
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
    wording: Wording = field(default=RESCALED, compare=False, repr=False)

    def __init__(
        self, rescaled_load: ArrayLike, rescaled_friction: ArrayLike, wording: Wording = RESCALED
    ) -> None:
        load = check.array("rescaled_load", rescaled_load, shape=(None,))
        friction = check.array("rescaled_friction", rescaled_friction, shape=(len(load),))
        object.__setattr__(self, "rescaled_load", check.increasing("rescaled_load", load))
        object.__setattr__(self, "rescaled_friction", check.increasing("rescaled_friction", friction))
        object.__setattr__(self, "wording", Wording.checked(wording))

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> OperatingPoints:
        """Points from loads P_i and friction forces F_i, both (k,) [N], of a material pair."""
        wording = Wording.of(material, friction)
        return cls(*wording.rescaled(load, friction_force), wording)

    @property
    def title(self) -> str:
        """What is asked for, in one line."""
        return f"Friction law through {len(self.rescaled_load)} operating points"

    @property
    def last_load(self) -> float:
        """Last rescaled load asked for [mm^2]."""
        return float(self.rescaled_load[-1])


@checked_class
@dataclass(frozen=True, eq=False, init=False, repr=False)
class SampledLaw(Value):
    """A law given by samples; the design minimises the squared relative differences.

    Parameters
    ----------
    rescaled_load : array_like, (k,)
        P/E* [mm^2], positive and increasing.
    rescaled_friction : array_like, (k,)
        F/(sigma B) [mm^2], positive and increasing.
    weight : array_like, (k,), optional
        Positive weights of the squared relative differences; default: equal.

    Examples
    --------
    >>> law = SampledLaw([0.1, 0.2, 0.3], [0.9, 1.6, 2.2])
    >>> law.weight
    array([1., 1., 1.])
    """

    rescaled_load: FloatArray
    rescaled_friction: FloatArray
    weight: FloatArray
    wording: Wording = field(default=RESCALED, compare=False, repr=False)

    def __init__(
        self,
        rescaled_load: ArrayLike,
        rescaled_friction: ArrayLike,
        weight: ArrayLike | None = None,
        wording: Wording = RESCALED,
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
        object.__setattr__(self, "wording", Wording.checked(wording))

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> SampledLaw:
        """Samples from loads P and friction forces F, both (k,) [N], of a material pair."""
        wording = Wording.of(material, friction)
        return cls(*wording.rescaled(load, friction_force), wording=wording)

    @property
    def title(self) -> str:
        """What is asked for, in one line."""
        return f"Friction law given by {len(self.rescaled_load)} samples"

    @property
    def last_load(self) -> float:
        """Last rescaled load asked for [mm^2]."""
        return float(self.rescaled_load[-1])

    @property
    def branches(self) -> tuple[()]:
        """No straight branches."""
        return ()


@checked_class
@dataclass(frozen=True, init=False)
class PowerLaw:
    """Friction proportional to a power of the load over a range, ``F/(sigma B) = C (P/E*)^beta``.

    Parameters
    ----------
    exponent : float
        beta [-], positive; surfaces of equal radii have an exponent of at least 2/3.
    load_range : (float, float)
        P/E* from and to [mm^2], positive and increasing.
    prefactor : float, optional
        C [mm^(2 - 2 beta)], positive; default: free.

    Examples
    --------
    >>> PowerLaw(1.2, (0.1, 0.4)).prefactor is None
    True
    """

    exponent: float
    load_range: tuple[float, float]
    prefactor: float | None
    wording: Wording = field(default=RESCALED, compare=False, repr=False)

    def __init__(
        self,
        exponent: float,
        load_range: ArrayLike,
        prefactor: float | None = None,
        wording: Wording = RESCALED,
    ) -> None:
        object.__setattr__(self, "exponent", check.number("exponent", exponent, above=0.0))
        object.__setattr__(self, "load_range", check.interval("load_range", load_range))
        object.__setattr__(self, "wording", Wording.checked(wording))
        value = None if prefactor is None else check.number("prefactor", prefactor, above=0.0)
        object.__setattr__(self, "prefactor", value)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> PowerLaw:
        """Law with the least-squares exponent and prefactor through points P, F, (k >= 2,) [N]."""
        wording = Wording.of(material, friction)
        x, y = wording.rescaled(load, friction_force)
        if len(x) < 2:
            raise InvalidInput(f"load holds {len(x)} value; an exponent needs at least 2 points")
        exponent, height = np.polyfit(np.log(x), np.log(y), 1)
        return cls(float(exponent), (float(x[0]), float(x[-1])), float(np.exp(height)), wording)

    @property
    def title(self) -> str:
        """What is asked for, in one line."""
        return in_title(
            f"Power law of exponent {self.exponent:.4g} from {self.wording.loads(*self.load_range)}"
        )

    @property
    def last_load(self) -> float:
        """Last rescaled load asked for [mm^2]."""
        return self.load_range[1]

    @property
    def branches(self) -> tuple[()]:
        """No straight branches."""
        return ()


Target = OperatingPoints | LinearLaw | BilinearLaw | SampledLaw | PowerLaw | MultilinearLaw
