"""Asperities of several radii with the same height density."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.errors import Infeasible
from metafem.inversion.assessment import MISSED, independent_misfit
from metafem.inversion.targets.wording import Message
from metafem.models.model import PARABOLOID

if TYPE_CHECKING:
    from metafem.inversion.candidate import Candidate
    from metafem.inversion.problem import Problem


# A mixture of two tools for a density is chosen only if it lowers the misfit by this factor: parts made with
# one tool are simpler.
MIXTURE_GAIN = 0.5

# Fractions of the larger of two neighbouring tools that are tried.
MIXTURE_FRACTIONS = tuple(i / 16 for i in range(1, 16))


@dataclass(frozen=True)
class Mixture:
    """Numbers of asperities of each radius [mm]; different radii require power caps.

    With one height density and Hertz contacts ``A0 = pi N <R> <d>`` and ``P/E* = 4/3 N <sqrt R> <d^(3/2)>``.
    This is the law of ``N <sqrt R>^2/<R>`` asperities of the radius ``(<R>/<sqrt R>)^2``. For a power cap
    rho^n, A is proportional to R^(2m) and P to R^m with m = 1 - 1/n, and R^m replaces sqrt(R).
    """

    radii: tuple[float, ...]
    numbers: tuple[int, ...]
    law: Contact = PARABOLOID

    @classmethod
    def of(cls, radius: FloatArray, law: Contact) -> Mixture:
        """Return the mixture of given radii (n,) [mm]."""
        radii, numbers = np.unique(radius, return_counts=True)
        return cls(tuple(radii.tolist()), tuple(numbers.tolist()), law)

    @property
    def count(self) -> int:
        """N."""
        return sum(self.numbers)

    @property
    def radius(self) -> float:
        """Radius of asperities that have the same law [mm]."""
        if len(self.radii) == 1 or self._power == 0.0:  # the law of a cone is the same for all radii
            return self.radii[0]
        return float((self._mean(2.0 * self._power) / self._mean(self._power)) ** (1.0 / self._power))

    @property
    def carrying(self) -> float:
        """Number of asperities of that radius with the same law."""
        if len(self.radii) == 1:
            return self.count
        return self.count * self._mean(self._power) ** 2 / self._mean(2.0 * self._power)

    @property
    def asperities(self) -> tuple[float, float, Contact]:
        """Number, radius and law of asperities of one radius with the same law."""
        return self.carrying, self.radius, self.law

    @property
    def _power(self) -> float:
        """The exponent m of R in the load."""
        return 1.0 - 1.0 / (self.law.power or 1.0)

    def _mean(self, power: float) -> float:
        pairs = zip(self.radii, self.numbers, strict=True)
        return math.fsum(number * radius**power for radius, number in pairs) / self.count

    def mixed(self) -> FloatArray:
        """Return the radius of each height in order, evenly mixed, (N,) [mm]."""
        if len(self.radii) == 1:
            return np.full(self.count, self.radii[0])
        numbers, used = np.array(self.numbers), np.zeros(len(self.numbers))
        order = []
        for i in range(self.count):
            most_behind = int((numbers * (i + 1) / self.count - used).argmax())
            used[most_behind] += 1.0
            order.append(most_behind)
        return np.array(self.radii)[order]


def best_mixture(invert: Callable[[Mixture], Candidate], problem: Problem) -> Candidate:
    """Return the candidate of the best single radius, or of two tools if their misfit is far smaller.

    Candidates with warnings, whose heights are too fine to manufacture, rank after those without.
    """
    radii, count = problem.radii, problem.count
    law = problem.independent.contact
    mixtures = [Mixture((radius,), (count,), law) for radius in radii.tried.tolist()]
    if radii.single:
        return invert(mixtures[0])
    if radii.tools is not None and law.power is not None:
        numbers = sorted({round(fraction * count) for fraction in MIXTURE_FRACTIONS} - {0, count})
        mixtures += [Mixture(pair, (count - n, n), law) for pair in pairwise(radii.tools) for n in numbers]
    refused: dict[float, Infeasible] = {}
    found: list[tuple[bool, float, Candidate]] = []
    for mixture in mixtures:
        try:
            candidate = invert(mixture)
        except Infeasible as reason:
            refused.setdefault(mixture.radius, reason)
        else:
            misfit = independent_misfit(problem, candidate)
            unsound = any(note.warns for note in candidate.notes) or misfit > MISSED
            gain = 1.0 if len(mixture.radii) == 1 else MIXTURE_GAIN
            found.append((unsound, misfit / gain, candidate))
    if not found:
        raise unreachable(refused)
    return min(found, key=lambda each: each[:2])[2]


def unreachable(refused: dict[float, Infeasible]) -> Infeasible:
    """Return the error that no radius reaches a target, with reasons for the smallest and largest radius."""
    parts: list[Any] = ["no radius reaches the target"]
    for sign, radius in zip(":;", dict.fromkeys((min(refused), max(refused))), strict=False):
        parts += [f"{sign} with a radius of {radius:.4g} mm, ", refused[radius].message]
    by_search = any(reason.by_search for reason in refused.values())
    return Infeasible(Message(parts), refused[min(refused)].nearest, by_search)
