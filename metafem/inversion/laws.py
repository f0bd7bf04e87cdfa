"""Targets defined by points, samples, a power law or a band, in P/E* and F/(sigma B) [mm^2]."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.inversion.target_law import Target, TargetLaw
from metafem.inversion.wording import LoadRange, Wording
from metafem.surface import Friction, Material

# Number of loads at which a power law is compared with the law of a design.
POINTS = 30


@dataclass(frozen=True, eq=False, repr=False)
class OperatingPoints(Target):
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
        If the arrays differ in length, a value is not finite, or the points do not increase.

    Examples
    --------
    >>> points = OperatingPoints([0.144, 0.336, 0.649], [0.84, 1.68, 4.12])
    >>> len(points.rescaled_load)
    3
    """

    exact: ClassVar[bool] = True
    refused: ClassVar[bool] = True

    rescaled_load: Any
    rescaled_friction: Any

    def _checked(self) -> dict[str, Any]:
        load = check.array("rescaled_load", self.rescaled_load, shape=(None,))
        friction = check.array("rescaled_friction", self.rescaled_friction, shape=load.shape)
        return {
            "rescaled_load": check.increasing("rescaled_load", load),
            "rescaled_friction": check.increasing("rescaled_friction", friction),
        }

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        return f"Friction law through {len(self.rescaled_load)} operating points"

    def curve(self) -> TargetLaw:
        """Return the points as a target law."""
        return TargetLaw.of(self.rescaled_load, self.rescaled_friction, pointwise=True)

    def near(self, load: FloatArray, friction: FloatArray) -> Target | None:
        """Return the points of a law; None if its friction does not increase."""
        rises = bool((np.diff(friction) > 0.0).all())
        return OperatingPoints(load, friction, wording=self.wording) if rises else None


@dataclass(frozen=True, eq=False, repr=False)
class SampledLaw(Target):
    """A law defined by samples; the design minimises the squared relative differences from the samples.

    Measured samples are allowed: the friction need not increase. If no surface meets all samples, the design
    is the surface with the nearest law. The target is refused if this law misses the samples by more than
    1 % plus their errors.

    Parameters
    ----------
    rescaled_load : array_like, (k,)
        P/E* [mm^2], positive and increasing.
    rescaled_friction : array_like, (k,)
        F/(sigma B) [mm^2], positive.
    weight : array_like, (k,), optional
        Positive weights of the squared relative differences. Default: ``1/relative_error**2``, or equal
        weights without errors.
    relative_error : array_like, (k,), optional
        Relative standard deviations of the frictions [-], positive and below 1. Default: None; the samples
        are exact.

    Raises
    ------
    InvalidInput
        If the arrays differ in length, a value is not finite or not positive, the loads do not increase, or
        an error is 1 or larger.

    Examples
    --------
    >>> law = SampledLaw([0.1, 0.2, 0.3], [0.9, 1.6, 2.2])
    >>> law.weight
    array([1., 1., 1.])
    >>> SampledLaw([0.1, 0.2], [0.9, 1.6], relative_error=[0.02, 0.01]).weight.round(6)
    array([ 2500., 10000.])
    """

    refused: ClassVar[bool] = True
    rising: ClassVar[bool] = False

    rescaled_load: Any
    rescaled_friction: Any
    weight: Any = None
    relative_error: Any = None

    def _checked(self) -> dict[str, Any]:
        load = check.array("rescaled_load", self.rescaled_load, shape=(None,))
        members = {"rescaled_load": check.increasing("rescaled_load", load)}
        given = {"rescaled_friction": self.rescaled_friction, "weight": self.weight}
        if self.relative_error is not None:
            given = {"relative_error": self.relative_error, **given}
        for name, value in given.items():
            if value is None:
                value = members["relative_error"] ** -2.0 if "relative_error" in members else 0.0 * load + 1.0
            members[name] = check.array(name, value, shape=load.shape, positive=True)
        error = members.get("relative_error", 0.0 * load)
        check.refuse_entries("relative_error", error, error >= 1.0, "must be below 1; 3 % is 0.03")
        return members

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        return f"Friction law given by {len(self.rescaled_load)} samples"

    def curve(self) -> TargetLaw:
        """Return the samples as a target law, with their weights and errors."""
        error = self.relative_error
        noise = 0.0 if error is None else float(np.sqrt(np.average(error**2, weights=self.weight)))
        return TargetLaw.of(self.rescaled_load, self.rescaled_friction, weight=self.weight, noise=noise)


@dataclass(frozen=True, eq=False, repr=False)
class PowerLaw(Target):
    """Friction proportional to a power of the load, ``F/(sigma B) = C (P/E*)^beta``, over a range of loads.

    Parameters
    ----------
    exponent : float
        beta [-], positive. Hertz contacts of equal radii have an exponent of at least 2/3.
    load_range : (float, float)
        Smallest and largest P/E* [mm^2], positive and increasing.
    prefactor : float, optional
        C [mm^(2 - 2 beta)], positive; default: free.

    Raises
    ------
    InvalidInput
        If a value is not positive, or the range does not increase.

    Examples
    --------
    >>> PowerLaw(1.2, (0.1, 0.4)).prefactor is None
    True
    """

    free_name: ClassVar[str] = "prefactor"
    fewest: ClassVar[int] = 2

    exponent: float
    load_range: LoadRange
    prefactor: float | None = None

    def _checked(self) -> dict[str, Any]:
        for name in ("exponent", "prefactor"):
            check.member(self, name, optional=name == "prefactor", above=0.0)
        return {"load_range": check.interval("load_range", self.load_range)}

    @classmethod
    def _through(cls, load: FloatArray, friction: FloatArray) -> tuple[Any, ...]:
        exponent, height = np.polyfit(np.log(load), np.log(friction), 1)
        return float(exponent), (load[0], load[-1]), float(np.exp(height))

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        loads = self.wording.title_loads(*self.load_range)
        return f"Power law of exponent {self.exponent:.4g} from {loads}"

    def curve(self) -> TargetLaw:
        """Return the power law at logarithmically spaced loads."""
        load = np.geomspace(*self.load_range, POINTS)
        shape = load**self.exponent
        if self.prefactor is not None:
            return TargetLaw.of(load, self.prefactor * shape)
        return TargetLaw.of(load, np.zeros(POINTS), free=shape[:, None])

    def near(self, load: FloatArray, friction: FloatArray) -> Target | None:
        """Return the power law with a free prefactor that is fitted to a law in logarithms."""
        return PowerLaw(self._through(load, friction)[0], self.load_range, wording=self.wording)


@dataclass(frozen=True, eq=False, repr=False)
class Band(Target):
    """Any law between two curves.

    The search aims at the inner half of the band. The misfit of a design is its largest relative distance
    from the band at a load of the target, and 0 within the band.

    Parameters
    ----------
    rescaled_load : array_like, (k,)
        P/E* [mm^2], positive and increasing. Between the loads the law is free.
    lowest, highest : array_like, (k,)
        Ends of F/(sigma B) [mm^2] at these loads, positive, each `lowest` below its `highest`.

    Raises
    ------
    InvalidInput
        If the arrays differ in length, a value is not finite or not positive, the loads do not increase, or
        a lowest friction is not below the highest.

    Examples
    --------
    >>> import metafem as mf
    >>> template = mf.Surface.square_lattice(0.12, radius=0.526, material=mf.Material(1.36))
    >>> design = mf.design(Band([0.1, 0.2, 0.3], [0.8, 1.4, 2.1], [0.9, 1.6, 2.4]), template)
    >>> design.misfit
    0.0
    """

    refused: ClassVar[bool] = True

    rescaled_load: Any
    lowest: Any
    highest: Any

    def _checked(self) -> dict[str, Any]:
        load = check.array("rescaled_load", self.rescaled_load, shape=(None,))
        low, high = (
            check.array(name, getattr(self, name), shape=load.shape, positive=True)
            for name in ("lowest", "highest")
        )
        check.refuse_entries("lowest", low, low >= high, "must be below highest at the same load")
        load = check.increasing("rescaled_load", load)
        return {"rescaled_load": load, "lowest": low, "highest": high}

    @classmethod
    def from_forces(  # type: ignore[override]
        cls, load: ArrayLike, lowest: ArrayLike, highest: ArrayLike, material: Material, friction: Friction
    ) -> Self:
        """Return the target for loads P and ends of the friction force, (k,) each [N], of a material pair."""
        wording = Wording.of(material, friction)
        x, low = wording.rescaled(load, lowest, rising=False)
        return cls(x, low, wording.rescaled(load, highest, rising=False)[1], wording=wording)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        count = len(self.rescaled_load)
        return f"Friction law within a band at {count} load{'s' if count > 1 else ''}"

    def curve(self) -> TargetLaw:
        """Return the band, which is compared with a law pointwise."""
        return TargetLaw.of(self.rescaled_load, self.lowest, self.highest, pointwise=True)
