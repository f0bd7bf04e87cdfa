"""Laws of single contacts as tables of the contact radius, and their sums over independent asperities."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]

# Points of a table over the contact radius, and of the rising plane over the approach.
POINTS, APPROACHES = 200_001, 20_001


class Table(NamedTuple):
    """Indentation [mm], area [mm²] and load P/E* [mm²] of one contact, in increasing order, (m,)."""

    indentation: FloatArray
    area: FloatArray
    load: FloatArray


def adhesive(adhesion_energy: float, modulus: float, radius: float, largest: float) -> Table:
    """Table of JKR's contact on loading, from indentation 0 to a largest contact radius [mm]."""
    strength = 2.0 * np.pi * adhesion_energy / modulus
    a = np.linspace((radius**2 * strength) ** (1.0 / 3.0), largest, POINTS)  # from indentation 0
    indentation = a**2 / radius - np.sqrt(strength * a)
    load = 4.0 * a**3 / (3.0 * radius) - 2.0 * a * np.sqrt(strength * a)
    return Table(indentation, np.pi * a**2, load)


def areas(table: Table, height: ArrayLike, load: ArrayLike) -> FloatArray:
    """Areas A0 (k,) [mm²] at which a rising plane first carries loads (k,) [mm²] on heights (n,) [mm].

    An adhesive contact begins with a jump of its load, which can lower the sum.
    """
    heights, wanted = np.asarray(height, dtype=float), np.asarray(load, dtype=float)
    gap = heights.max() - heights
    deepest = float(table.indentation[-1])
    grid = np.linspace(0.0, deepest, APPROACHES)
    approach = np.sort(np.concatenate([grid, gap, np.nextafter(gap, 0.0)]))
    approach = approach[(approach >= 0.0) & (approach <= deepest)]
    total, found = np.zeros((2, len(approach)))
    for each in gap:
        inside = approach >= each
        total[inside] += np.interp(approach[inside] - each, table.indentation, table.load)
        found[inside] += np.interp(approach[inside] - each, table.indentation, table.area)
    highest = np.maximum.accumulate(total)
    if wanted.max() > highest[-1]:
        raise ValueError(f"load = {wanted.max():g} mm² exceeds that of the table, {highest[-1]:g} mm²")
    step = np.searchsorted(highest, wanted)
    share = (wanted - total[step - 1]) / (total[step] - total[step - 1])
    return np.asarray(found[step - 1] + share * (found[step] - found[step - 1]))
