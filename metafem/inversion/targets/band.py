"""Target defined by two curves: any law between them meets it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem._values import Value, percent
from metafem.errors import Infeasible
from metafem.inversion.bounds import ROUNDING
from metafem.inversion.feasibility import margin_words, refuse_load
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.targets.laws import SampledLaw
from metafem.inversion.targets.target import Target
from metafem.inversion.targets.wording import RESCALED, Message, Wording
from metafem.surface import Friction, Material

if TYPE_CHECKING:
    from metafem.inversion.candidate import Candidate
    from metafem.inversion.problem import Problem


@dataclass(frozen=True, eq=False, init=False, repr=False)
class Band(Value, Target):
    """Any law between two curves.

    The search aims at the middle of the band, or at its inner half if the middle cannot be reached. The
    misfit of a design is its largest relative distance from the band at a load of the target, and 0 within
    the band.

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

    rescaled_load: FloatArray
    lowest: FloatArray
    highest: FloatArray
    wording: Wording = field(default=RESCALED, compare=False, repr=False)

    def __init__(
        self,
        rescaled_load: ArrayLike,
        lowest: ArrayLike,
        highest: ArrayLike,
        wording: Wording = RESCALED,
    ) -> None:
        load = check.increasing("rescaled_load", check.array("rescaled_load", rescaled_load, shape=(None,)))
        low = check.array("lowest", lowest, shape=load.shape, positive=True)
        high = check.array("highest", highest, shape=load.shape, positive=True)
        check.refuse_entries("lowest", low, low >= high, "must be below highest at the same load")
        self._set(wording, rescaled_load=load, lowest=low, highest=high)

    @classmethod
    def from_forces(
        cls, load: ArrayLike, lowest: ArrayLike, highest: ArrayLike, material: Material, friction: Friction
    ) -> Band:
        """Return the target for loads P and ends of the friction force, (k,) each [N], of a material pair."""
        wording = Wording.of(material, friction)
        modulus, stress = material.composite_modulus, friction.stress
        newtons = check.array("load", load, shape=(None,))
        low = check.array("lowest", lowest, shape=newtons.shape)
        high = check.array("highest", highest, shape=newtons.shape)
        return cls(newtons / modulus, low / stress, high / stress, wording)

    @property
    def title(self) -> str:
        """Description of the target in one line."""
        count = len(self.rescaled_load)
        return f"Friction law within a band at {count} load{'s' if count > 1 else ''}"

    @property
    def last_load(self) -> float:
        """Last rescaled load of the target [mm^2]."""
        return float(self.rescaled_load[-1])

    @property
    def middle(self) -> FloatArray:
        """Middle of the band, (k,) [mm^2]."""
        return np.asarray(0.5 * (self.lowest + self.highest))

    def curve(self) -> TargetLaw:
        """Return the band as a target law, which is compared with a law pointwise."""
        count = len(self.rescaled_load)
        free, ends = np.empty((count, 0)), (self.lowest, self.highest)
        return TargetLaw(self.rescaled_load, self.middle, free, np.ones(count), pointwise=True, ends=ends)

    def refuse(self, problem: Problem, margin: float) -> None:
        """Raise Infeasible if all laws in the band violate a proven bound by more than a relative margin.

        F/P^b of independent asperities cannot decrease, so the running maximum of its lowest values must
        stay below its highest value at each load.
        """
        load, wording, bounds = self.rescaled_load, self.wording, problem.bounds
        refuse_load(self.last_load, problem, wording)
        least, most = bounds.friction(load)
        power = load**bounds.least_exponent
        rising = np.maximum.accumulate(np.maximum(self.lowest, least) / power) * power
        slack = margin + ROUNDING
        for broken, words, bound in (
            (
                self.highest * (1.0 + slack) < least,
                "end of the band is below that of a single asperity",
                least,
            ),
            (
                self.lowest > most * (1.0 + slack),
                f"end of the band is above that of {bounds.count} equal asperities",
                most,
            ),
            (
                rising > self.highest * (1.0 + slack),
                "end of the band is below that of the asperities in contact at smaller loads",
                rising,
            ),
        ):
            if broken.any():
                i = int(broken.argmax())
                end = self.lowest if words.startswith("end of the band is above") else self.highest
                scope = f", for any surface of {problem.tools}{margin_words(margin)}"
                parts = (
                    "at load ",
                    ("loads", load[i]),
                    " the ",
                    "lowest " if end is self.lowest else "highest ",
                )
                raise Infeasible(
                    Message(
                        (
                            *parts,
                            words,
                            ", ",
                            ("frictions", end[i]),
                            " against ",
                            ("frictions", bound[i]),
                            scope,
                        ),
                        wording,
                    )
                )

    def candidate(self, problem: Problem, rng: np.random.Generator, restarts: int | None = None) -> Candidate:
        """Return independent asperities whose law is near the middle, or in the inner half of the band."""
        low, high = (0.5 * (end + self.middle) for end in (self.lowest, self.highest))
        inner = Band(self.rescaled_load, low, high)
        near = SampledLaw(self.rescaled_load, self.middle).candidate(problem, rng, restarts)
        law = inner.curve()
        area = problem.independent.curve_of(near.height, near.radius, law.load).area
        if law.misfit(area) > 0.0:
            found = super(Band, inner).candidate(problem, rng, restarts)
            new = problem.independent.curve_of(found.height, found.radius, law.load).area
            near = found if law.misfit(new) < law.misfit(area) else near
        return replace(near, target_law=law)

    def judged(self, problem: Problem, candidate: Candidate) -> Candidate:
        """Return the candidate with the whole band as its target, or raise Infeasible if it is outside."""
        band = self.curve()
        area = problem.model.curve(candidate.surface(problem.template), band.load).checked().area
        violation = np.abs(band.difference(area))
        if violation.any():
            i = int(violation.argmax())
            parts = ("no law within the band was found: at load ", ("loads", band.load[i]))
            words = f" the nearest law found is outside by {percent(float(violation[i]), '.3g')}"
            nearest = SampledLaw(self.rescaled_load, area, wording=self.wording)
            raise Infeasible(Message((*parts, words), self.wording), nearest, by_search=True)
        return replace(candidate, target_law=band)
