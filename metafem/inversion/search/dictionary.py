"""Initial guesses for asperities made by several tools, by non-negative least squares.

At given approaches x_k of the plane, load and area are linear in the numbers c of asperities with each tool
and each gap: ``sum c P(x_k - g) = P_k`` and ``sum c A(x_k - g) = F_k``. The approaches are not known; powers
of the load with several exponents and several largest values are tried. The solution has few non-zero
numbers, which are then rounded to whole asperities.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import nnls

from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.contact.law import contacts
from metafem.models.independent import load_equation

# Exponents m of the approaches ``x = X (P/P_K)^(1/m)``, and X over the largest difference of the heights.
POWERS = (1.0, 1.15, 1.3, 1.6, 2.0, 2.6, 3.5)
DEPTHS = (0.03, 0.1, 0.2, 0.3, 0.5, 1.0)

# Maximum number of loads.
LOADS = 30

# Number of gaps for each tool, which lie at approaches between the loads of the target.
GAPS = 40

# Maximum number of iterations of the least squares.
MOST_STEPS = 2000


@dataclass(frozen=True)
class Start:
    """Heights (n,) [mm], with the tallest equal to 0, and the indices of their tools, (n,)."""

    height: FloatArray
    which: IntArray


def starts(
    law: Contact, summits: Any, load: FloatArray, friction: FloatArray, span: float, count: int
) -> Iterator[Start]:
    """Yield initial guesses of at most `count` asperities whose law is near the frictions (k,) [mm^2].

    summits: what the law takes as `radius`, for each tool.
    """
    rows = np.unique(np.linspace(0.0, len(load) - 1.0, LOADS).round().astype(np.int64))
    load, friction = load[rows], friction[rows]
    tools, right = len(summits), np.ones(2 * len(load))
    which = np.tile(np.arange(tools), GAPS)
    for depth in DEPTHS:
        for power in POWERS:
            approach = depth * span * (load / load[-1]) ** (1.0 / power)
            at = np.linspace(0.0, len(load) - 1.0, GAPS)[1:]
            gap = np.insert(np.interp(at, np.arange(len(load)), approach), 0, 0.0)[:GAPS]
            gaps = np.repeat(gap, tools)
            try:
                loads, areas = _pressed(law, approach[:, None] - gaps, summits[which])
                columns = np.vstack([areas / friction[:, None], loads / load[:, None]])
                number, _ = nnls(columns, right, maxiter=MOST_STEPS)
            except (ValueError, RuntimeError):  # beyond the range of the law, or no solution
                continue
            used = np.flatnonzero(number)
            if used.size:
                yield _rounded(gaps[used], which[used], number[used], count)


def _pressed(law: Contact, depth: FloatArray, summits: Any) -> tuple[FloatArray, FloatArray]:
    """Return loads and areas [mm^2] of contacts at indentations (k, n) [mm]; 0 if open."""
    size = np.broadcast_to(summits, depth.shape)
    if law.adhesive:
        found = contacts(law, depth, size)
        return np.where(depth > 0.0, found.load, 0.0), np.where(depth > 0.0, found.area, 0.0)
    loads, _, areas, _ = load_equation(law).rates(depth, summits)
    return loads, areas


def _rounded(gap: FloatArray, which: IntArray, number: FloatArray, count: int) -> Start:
    """Return a whole number of asperities, at most `count`, from numbers that need not be integers."""
    order = np.lexsort((which, gap))
    total = np.cumsum(number[order])
    most = min(count, max(1, math.ceil(total[-1])))
    middle = (np.arange(most) + 0.5) / most * total[-1]
    rows = order[np.minimum(np.searchsorted(total, middle), len(order) - 1)]
    return Start(gap[rows[0]] - gap[rows], which[rows])
