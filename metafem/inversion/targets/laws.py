"""Targets defined by points, samples or a power law, in P/E* and F/(sigma B) [mm^2]."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value, percent
from metafem.errors import Infeasible
from metafem.inversion.assessment import largest_misfit
from metafem.inversion.bounds import ROUNDING
from metafem.inversion.feasibility import broken_sample, margin_words, nearest_within, refuse_load
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.strategies import operating_points
from metafem.inversion.targets.target import Target
from metafem.inversion.targets.wording import RESCALED, LoadRange, Message, Wording
from metafem.notes import information
from metafem.surface import Friction, Material

if TYPE_CHECKING:
    from metafem.inversion.bounds import Bounds
    from metafem.inversion.candidate import Candidate, Parameter
    from metafem.inversion.problem import Problem

# Number of loads at which a power law is compared with the law of a design.
POINTS = 30

# A note lists the samples outside the bounds up to this number; otherwise it states only how many there are.
MOST_LISTED = 8


@dataclass(frozen=True, eq=False, init=False, repr=False)
class OperatingPoints(Value, Target):
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

    rescaled_load: FloatArray
    rescaled_friction: FloatArray
    wording: Wording = field(default=RESCALED, compare=False, repr=False)

    def __init__(
        self,
        rescaled_load: ArrayLike,
        rescaled_friction: ArrayLike,
        wording: Wording = RESCALED,
    ) -> None:
        load = check.array("rescaled_load", rescaled_load, shape=(None,))
        friction = check.array("rescaled_friction", rescaled_friction, shape=(len(load),))
        load = check.increasing("rescaled_load", load)
        friction = check.increasing("rescaled_friction", friction)
        self._set(wording, rescaled_load=load, rescaled_friction=friction)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> OperatingPoints:
        """Return the target for loads P_i and friction forces F_i, both (k,) [N], of a material pair."""
        wording = Wording.of(material, friction)
        return cls(*wording.rescaled(load, friction_force), wording)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        return f"Friction law through {len(self.rescaled_load)} operating points"

    @property
    def last_load(self) -> float:
        """Last rescaled load of the target [mm^2]."""
        return float(self.rescaled_load[-1])

    def curve(self) -> TargetLaw:
        """Return the points as a target law."""
        return TargetLaw.fixed(self.rescaled_load, self.rescaled_friction, pointwise=True)

    candidate = operating_points.candidate
    judged = operating_points.judged


@dataclass(frozen=True, eq=False, init=False, repr=False)
class SampledLaw(Value, Target):
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

    rescaled_load: FloatArray
    rescaled_friction: FloatArray
    weight: FloatArray
    relative_error: FloatArray | None = None
    wording: Wording = field(default=RESCALED, compare=False, repr=False)

    def __init__(
        self,
        rescaled_load: ArrayLike,
        rescaled_friction: ArrayLike,
        weight: ArrayLike | None = None,
        relative_error: ArrayLike | None = None,
        wording: Wording = RESCALED,
    ) -> None:
        load = check.increasing("rescaled_load", check.array("rescaled_load", rescaled_load, shape=(None,)))
        each = (len(load),)
        friction = check.array("rescaled_friction", rescaled_friction, shape=each, positive=True)
        error = None
        if relative_error is not None:
            error = check.array("relative_error", relative_error, shape=each, positive=True)
            check.refuse_entries("relative_error", error, error >= 1.0, "must be below 1; 3 % is 0.03")
        given = weight
        if given is None:
            given = np.ones(each) if error is None else error**-2.0
        weights = check.array("weight", given, shape=each, positive=True)
        values = {"rescaled_friction": friction, "weight": weights, "relative_error": error}
        self._set(wording, rescaled_load=load, **values)

    @classmethod
    def from_forces(
        cls,
        load: ArrayLike,
        friction_force: ArrayLike,
        material: Material,
        friction: Friction,
        weight: ArrayLike | None = None,
        relative_error: ArrayLike | None = None,
    ) -> SampledLaw:
        """Return the target for loads P and friction forces F, both (k,) [N], of a material pair."""
        wording = Wording.of(material, friction)
        points = wording.rescaled(load, friction_force, rising=False)
        return cls(*points, weight, relative_error, wording)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        return f"Friction law given by {len(self.rescaled_load)} samples"

    @property
    def last_load(self) -> float:
        """Last rescaled load of the target [mm^2]."""
        return float(self.rescaled_load[-1])

    def curve(self) -> TargetLaw:
        """Return the samples as a target law, with their weights and errors."""
        error = self.relative_error
        noise = 0.0 if error is None else float(np.sqrt(np.average(error**2, weights=self.weight)))
        return TargetLaw.fixed(self.rescaled_load, self.rescaled_friction, self.weight, noise=noise)

    def guesses(self, law: TargetLaw, bounds: Bounds, fractions: tuple[float, ...]) -> list[FloatArray]:
        """Return the frictions within the bounds that are nearest to the samples, (k,) [mm^2]."""
        return [nearest_within(law.load, law.base, law.weight, bounds)]

    def refuse(self, problem: Problem, margin: float) -> None:
        """Raise Infeasible if a load is too large; `judged` checks the bounds on the friction."""
        refuse_load(self.last_load, problem, self.wording)

    def judged(self, problem: Problem, candidate: Candidate) -> Candidate:
        """Return the candidate with a note on samples outside the bounds, or raise Infeasible.

        The target is infeasible if samples are outside the bounds and the law misses the samples by too much.
        """
        load, wording, margin = self.rescaled_load, self.wording, 0.0
        broken = broken_sample(load, self.rescaled_friction, problem, wording, margin)
        if broken and (margin := problem.interaction_margin()):
            broken = broken_sample(load, self.rescaled_friction, problem, wording, margin)
        if not broken:
            return candidate
        law, surface = candidate.target_law, candidate.surface(problem.template)
        area = problem.model.curve(surface, load).checked().area
        misfit, most = law.misfit(area), largest_misfit(law)
        near = nearest_within(load, law.base, law.weight, problem.bounds) / law.base
        if misfit > most:
            words = (
                f"; the nearest law found misses the samples by {percent(misfit, '.3g')} rms, and "
                f"at most {percent(most, '.3g')} is allowed"
            )
            raise Infeasible(
                Message((broken, words)),
                SampledLaw(load, area, self.weight, self.relative_error, wording),
                by_search=law.misfit(near * law.base) <= most,
            )
        return replace(candidate, notes=(*candidate.notes, information(_outside(near - 1.0, margin))))


@dataclass(frozen=True, init=False)
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

    exponent: float
    load_range: LoadRange
    prefactor: float | None
    wording: Wording = field(default=RESCALED, compare=False, repr=False)

    def __init__(
        self,
        exponent: float,
        load_range: ArrayLike,
        prefactor: float | None = None,
        wording: Wording = RESCALED,
    ) -> None:
        self._set(
            wording,
            exponent=check.number("exponent", exponent, above=0.0),
            load_range=check.interval("load_range", load_range),
            prefactor=None if prefactor is None else check.number("prefactor", prefactor, above=0.0),
        )

    @classmethod
    def from_forces(
        cls, load: ArrayLike, friction_force: ArrayLike, material: Material, friction: Friction
    ) -> PowerLaw:
        """Return the power law fitted by least squares to points P, F, (k >= 2,) [N], in logarithms."""
        wording = Wording.of(material, friction)
        x, y = wording.rescaled(load, friction_force, "an exponent", 2)
        exponent, height = np.polyfit(np.log(x), np.log(y), 1)
        return cls(float(exponent), (float(x[0]), float(x[-1])), float(np.exp(height)), wording)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        loads = self.wording.title_loads(*self.load_range)
        return f"Power law of exponent {self.exponent:.4g} from {loads}"

    @property
    def marked_loads(self) -> dict[str, tuple[tuple[float, ...], ...]]:
        """The load range by name [mm^2]."""
        return {"load range": (self.load_range,)}

    @property
    def last_load(self) -> float:
        """Last rescaled load of the target [mm^2]."""
        return self.load_range[1]

    def curve(self) -> TargetLaw:
        """Return the power law at logarithmically spaced loads."""
        load = np.geomspace(*self.load_range, POINTS)
        shape = load**self.exponent
        if self.prefactor is not None:
            return TargetLaw.fixed(load, self.prefactor * shape)
        return TargetLaw(load, np.zeros(POINTS), shape[:, None], np.ones(POINTS))

    def guesses(self, law: TargetLaw, bounds: Bounds, fractions: tuple[float, ...]) -> list[FloatArray]:
        """Return the power law, or power laws with several prefactors within the bounds if C is free."""
        if self.prefactor is not None:
            return [law.base]
        shape = law.free[:, 0]
        least, most = _levels(bounds.region(law.load), shape)
        return [shape * least * (most / least) ** fraction for fraction in fractions]

    def open_parameters(self, law: TargetLaw, area: FloatArray) -> dict[str, Parameter]:
        """Return the fitted prefactor [mm^(2 - 2 beta)] if it is free."""
        return {"prefactor": float(law.open_parameters(area)[0])} if self.prefactor is None else {}

    def refuse(self, problem: Problem, margin: float) -> None:
        """Raise Infeasible if the exponent or prefactor exceeds a bound by more than a relative margin."""
        (low, high), radii, wording = self.load_range, problem.tools, self.wording
        refuse_load(high, problem, wording)
        bounds = problem.bounds
        least, most = bounds.least_exponent, bounds.largest_exponent(self.load_range)
        slack = margin / math.log(high / low) + ROUNDING
        if not least - slack <= self.exponent <= most + slack:
            raise Infeasible(
                f"exponent {self.exponent:g} over loads from {wording.loads(low, high)} cannot be reached: "
                f"at least {least:.4g} and at most {most:.4g} with {problem.count} asperities of "
                f"{'one radius' if radii.single else radii}"
                f"{margin_words(margin)}",
                PowerLaw(min(max(self.exponent, least), most), self.load_range, wording=wording),
            )
        if self.prefactor is None:
            return
        load = np.array(self.load_range)
        point = f"prefactor = {self.prefactor:g}: the friction at ", ", ", ","
        friction = self.prefactor * load**self.exponent
        broken = broken_sample(load, friction, problem, wording, margin, point)
        if broken:  # no nearest target is stated: a prefactor within the bounds may still be unreachable
            raise Infeasible(Message((broken, "; without prefactor the design chooses it")))


def _levels(bounds: tuple[FloatArray, FloatArray], shape: FloatArray) -> tuple[float, float]:
    """Return the smallest and largest factor for which a law (k,) lies between two bounds, (k,) each."""
    low, high = bounds
    return float((low / shape).max()), float((high / shape).min())


def _outside(difference: FloatArray, margin: float) -> str:
    """Return a text on samples that no surface meets; `difference` (k,) [-] is that from the nearest law."""
    rows, most = np.flatnonzero(np.abs(difference) > ROUNDING), int(np.abs(difference).argmax())
    which = f" ({', '.join(map(str, rows + 1))})" if len(rows) <= MOST_LISTED else ""
    largest = percent(float(abs(difference[most])))
    return (
        f"no surface meets all samples{margin_words(margin)}: {len(rows)} of {len(difference)}{which} differ "
        f"from the nearest law within the bounds, by up to {largest} (sample {most + 1}); the design has the "
        "least rms difference that was found"
    )
