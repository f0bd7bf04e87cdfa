"""Mixtures of asperities with several radii and the same height density."""

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


# A mixture of two tools is chosen only if its misfit is below this fraction of the misfit with one tool,
# because parts are simpler to manufacture with one tool.
MIXTURE_GAIN = 0.5

# Fractions of asperities with the larger radius that are tried for two neighbouring tools.
MIXTURE_FRACTIONS = tuple(i / 16 for i in range(1, 16))


@dataclass(frozen=True)
class Mixture:
    """Numbers of asperities with each radius [mm]; different radii require power caps.

    If all radii have the same height density, Hertz contacts have ``A0 = pi N <R> <d>`` and
    ``P/E* = 4/3 N <sqrt R> <d^(3/2)>``. This is the law of ``N <sqrt R>^2/<R>`` asperities with the single
    radius ``(<R>/<sqrt R>)^2``. For a power cap rho^n, A is proportional to R^(2m) and P to R^m with
    m = 1 - 1/n. R^m then replaces sqrt(R).
    """

    radii: tuple[float, ...]
    numbers: tuple[int, ...]
    law: Contact = PARABOLOID

    @classmethod
    def of(cls, radius: FloatArray, law: Contact) -> Mixture:
        """Return the mixture of asperities with radii (n,) [mm]."""
        radii, numbers = np.unique(radius, return_counts=True)
        return cls(tuple(radii.tolist()), tuple(numbers.tolist()), law)

    @property
    def count(self) -> int:
        """Total number N of asperities."""
        return sum(self.numbers)

    @property
    def radius(self) -> float:
        """Radius [mm] of equal asperities with the same law as the mixture."""
        if len(self.radii) == 1 or self._power == 0.0:  # the law of a cone is the same for all radii
            return self.radii[0]
        return float((self._mean(2.0 * self._power) / self._mean(self._power)) ** (1.0 / self._power))

    @property
    def carrying(self) -> float:
        """Number of asperities of that radius with the same law as the mixture; it need not be an integer."""
        if len(self.radii) == 1:
            return self.count
        return self.count * self._mean(self._power) ** 2 / self._mean(2.0 * self._power)

    @property
    def asperities(self) -> tuple[float, float, Contact]:
        """Number, radius [mm] and contact law of equal asperities with the same friction law."""
        return self.carrying, self.radius, self.law

    @property
    def _power(self) -> float:
        """Exponent m of R in the load [-]."""
        return 1.0 - 1.0 / (self.law.power or 1.0)

    def _mean(self, power: float) -> float:
        pairs = zip(self.radii, self.numbers, strict=True)
        return math.fsum(number * radius**power for radius, number in pairs) / self.count

    def mixed(self) -> FloatArray:
        """Return the radius of each height in order, (N,) [mm], with the radii evenly mixed."""
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
    """Return the candidate with the best single radius, or with two tools if their misfit is far smaller.

    Candidates rank last if they have warnings, because their heights are too fine to manufacture, or if they
    miss the target.
    """
    radii, count = problem.radii, problem.count
    law = problem.contact.without_adhesion
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
