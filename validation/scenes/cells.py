"""Laws of random cells of 4 to 9 power caps with their own exponents."""

from __future__ import annotations

import math

import numpy as np

import metafem as mf
from metafem._validate import FloatArray

RADIUS, PITCH = 0.526, 1.5
LIMITS = mf.Limits(0.15)
LOADS = 30


def cell(seed: int) -> tuple[mf.Surface, FloatArray]:
    """Return a cell of random heights and exponents, and increasing loads P/E* (30,) [mm^2].

    At the last load about the lowest summit comes into contact.
    """
    rng = np.random.default_rng(seed)
    count = int(rng.integers(4, 10))
    columns = math.ceil(math.sqrt(count))
    lattice = mf.Surface.square_lattice(
        LIMITS.max_height, (columns, columns), PITCH, radius=RADIUS, material=mf.Material(1.36)
    )
    height = LIMITS.max_height - rng.uniform(0.0, 0.1, count)
    cap = [mf.Power(n) for n in rng.uniform(1.3, 5.0, count)]
    surface = lattice.only(slice(count), height=height, cap=cap)
    approach = np.array([0.1 * rng.uniform(0.6, 1.3)])
    full = float(mf.Independent(mf.Elastic()).curve(surface, approach=approach).load[-1])
    return surface, full * np.arange(1, LOADS + 1) / LOADS
