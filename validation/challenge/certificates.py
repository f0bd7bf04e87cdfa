"""Certificates: proofs that no surface has a smaller misfit than a stated number, checked with numpy.

    python -m validation.challenge.certificates

They hold for N independent asperities with paraboloids of one radius R. Let A(p) be the area at the load
p = P/E*, ``A1(p) = pi R d1(p)`` that of one asperity alone with the indentation
``d1(p) = (3 p/(4 sqrt R))^(2/3)``, and d_i > 0 the indentations of the n contacts. Then

rises    ``A(q)/q^(2/3) >= A(p)/p^(2/3)`` for q > p. The approach of the plane changes p by
         ``2 sqrt R S(1/2)`` and A by ``pi R n`` per length, with ``S(m) = sum d_i^m``; new contacts have no
         area. So ``d ln A/d ln p = 2/3 n S(3/2)/(S(1/2) S(1)) >= 2/3``, because ``n sum x_i y_i`` is at
         least ``sum x_i sum y_i`` for numbers in the same order (Chebyshev), here sqrt d_i and d_i.
least    ``A(p) >= A1(p)``: A1 is concave with A1(0) = 0, so it is subadditive over the loads of the contacts.
most     ``A(p) <= N A1(p/N)``: A1 is concave (Jensen).
jump     ``A(q) - A(p) <= N pi R (d1(q) - d1(p))``: no area grows by more than pi R times the motion of the
         plane, and the plane moves by at most d1(q) - d1(p), because the stiffness of contacts, sum of
         2 a(P_i), is at least 2 a(p) of one contact with their whole load: a is concave in the load, too.
steep    ``A(q)^3 - A(p)^3 <= K (q^2 - p^2)`` with ``K = 9 N pi^3 R^2/16``, because
         ``d(A^3)/dp = 3/2 pi^3 R^(5/2) n S(1)^2/S(1/2)`` and ``2 K p = 3/2 N pi^3 R^(5/2) S(3/2)``, and
         ``S(1)^2 <= S(1/2) S(3/2)`` (Cauchy and Schwarz), n <= N. A(q) is thus below a convex function of
         A(p), and below its chord over any interval in which A(p) lies.

With ``x_i = A(p_i)/F_i`` at the loads and frictions of the target, all of these are linear, ``C x >= b``. For
any multipliers m >= 0 and any such x, by completing the square,

    sum (x_i - 1)^2 >= sum (x_i - 1)^2 - m.(C x - b) >= m.(b - C 1) - |C^T m|^2/4,

so the mean of the left side, the square of the misfit, has this bound over the number of loads (weak
duality). For a target with a free prefactor the multipliers use `rises` alone, which does not change when x
is multiplied by a number. If s^2 is the bound, any multiple of x has ``mean (c x - 1)^2 >= s^2``; the best c
has ``1 - mean(x)^2/mean(x^2)``, so that the misfit, the deviation of x over its mean, is at least
``s/sqrt(1 - s^2)``.
A certificate divides the possible areas at one load, ``A1(p)`` to ``N A1(p/N)``, into intervals. In each case
the rows `least`, `most` and `steep` of this load use its interval; the bound is the least of all cases.

Whoever doubts the solver that found the multipliers need not trust it: any multipliers
prove a bound, and the file only chooses good ones.
"""

from __future__ import annotations

import json
import math
import sys
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from validation.challenge.task import Target, names, target

FOLDER = Path(__file__).parent / "certificates"

# Relative amount by which a stated bound may exceed the computed one: six digits are written.
ROUNDING = 1e-5

# A row of C x >= b: its kind and the indices of one load or of two.
Row = tuple[str, int, int]


@dataclass(frozen=True)
class Case:
    """All laws of a target whose area at one load is in an interval."""

    wanted: Target
    load: int  # index of the load
    low: float  # [mm^2]
    high: float

    def rows(self) -> list[Row]:
        """Return all rows that are proven."""
        k = len(self.wanted.friction.load)
        pairs = [(i, j) for i in range(k) for j in range(i + 1, k)]
        found: list[Row] = [("rises", i, j) for i, j in pairs if j == i + 1]  # the others follow
        if not self.wanted.friction.free:
            found += [(kind, i, j) for kind in ("jump", "steep") for i, j in pairs]
            found += [(kind, i, i) for kind in ("least", "most") for i in range(k)]
        return found

    def interval(self, i: int) -> tuple[float, float]:
        """Return the smallest and largest possible area at a load [mm^2]."""
        return (self.low, self.high) if i == self.load else possible(self.wanted, i)

    def constraint(self, row: Row) -> tuple[np.ndarray, float]:
        """Return one line of C (k,) and b."""
        kind, i, j = row
        wanted = self.wanted
        load, wish, radius = wanted.friction.load, wanted.friction.value, wanted.tools[0].radius
        line = np.zeros(len(load))
        low, high = self.interval(i)
        if kind == "rises":
            least = load ** (2.0 / 3.0)
            line[j], line[i] = wish[j] / least[j], -wish[i] / least[i]
            return line, 0.0
        if kind == "jump":
            line[i], line[j] = wish[i], -wish[j]
            return line, -wanted.count * (alone(radius, load[j]) - alone(radius, load[i]))
        if kind == "steep":
            more = 9.0 / 16.0 * wanted.count * math.pi**3 * radius**2 * (load[j] ** 2 - load[i] ** 2)
            first, last = ((area**3 + more) ** (1.0 / 3.0) for area in (low, high))
            slope = (last - first) / (high - low)
            line[i], line[j] = slope * wish[i], -wish[j]
            return line, slope * low - first
        line[i] = wish[i] if kind == "least" else -wish[i]
        return line, low if kind == "least" else -high

    def bound(self, multipliers: list[tuple[str, int, int, float]]) -> float:
        """Return the proven lower bound of the misfit [-] from rows with their multipliers."""
        proven = set(self.rows())
        total, slope = 0.0, np.zeros(len(self.wanted.friction.load))
        for kind, i, j, value in multipliers:
            if (kind, i, j) not in proven or not value >= 0.0:
                raise ValueError(
                    f"{kind}, {i}, {j}, {value} is no proven row with a multiplier of at least 0"
                )
            line, least = self.constraint((kind, i, j))
            total += value * (least - line.sum())
            slope += value * line
        square = max(total - 0.25 * float(slope @ slope), 0.0) / len(slope)
        return math.sqrt(square / (1.0 - square)) if self.wanted.friction.free else math.sqrt(square)


def alone(radius: float, p: float) -> float:
    """Return the area A1 of one paraboloid at a load [mm^2]."""
    return math.pi * radius * (0.75 * p / math.sqrt(radius)) ** (2.0 / 3.0)


def possible(wanted: Target, i: int) -> tuple[float, float]:
    """Return the area of one asperity and of N equal ones at a load of the target [mm^2]."""
    radius, p, n = wanted.tools[0].radius, float(wanted.friction.load[i]), wanted.count
    return alone(radius, p), n * alone(radius, p / n)


def certificate(name: str) -> dict[str, Any]:
    """Return the certificate of a target."""
    found: dict[str, Any] = json.loads((FOLDER / f"{name}.json").read_text("utf-8"))
    return found


def certified() -> list[str]:
    """Return the names of the targets that have a certificate."""
    return [name for name in names() if (FOLDER / f"{name}.json").exists()]


def checked(name: str) -> float:
    """Return the bound of a certificate; raise ValueError if it proves less than it states."""
    found = certificate(name)
    wanted = target(name)
    if len(wanted.tools) != 1 or wanted.tools[0].exponent != 2.0 or wanted.resolved or wanted.height_sd:
        raise ValueError(f"{name}: the proof holds for independent paraboloids of one radius")
    load, edges = found["load"], found["edges"]
    least, most = possible(wanted, load)
    if (
        edges[0] > least
        or edges[-1] < most
        or edges != sorted(edges)
        or len(edges) != len(found["cases"]) + 1
    ):
        raise ValueError(f"{name}: the intervals must cover all areas from {least:g} to {most:g} mm^2")
    cases = [Case(wanted, load, low, high) for low, high in pairwise(edges)]
    proven = min(case.bound(own) for case, own in zip(cases, found["cases"], strict=True))
    if found["bound"] > proven * (1.0 + ROUNDING):
        raise ValueError(f"{name}: states {found['bound']:g}, and its multipliers prove {proven:g}")
    return proven


def main() -> int:
    """Check all certificates."""
    for name in certified():
        print(f"{name}: no surface has a misfit below {100.0 * checked(name):.5g} %")
    return 0


if __name__ == "__main__":
    sys.exit(main())
