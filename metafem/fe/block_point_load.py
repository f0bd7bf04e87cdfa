"""A point load on the half-space, for unit E*: what is taken out of the block before elements see it."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray


def displacement(
    x: FloatArray, y: FloatArray, z: FloatArray, poisson_ratio: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Displacement at (x, y) from a unit normal load and at depth z >= 0, per unit of P/E* [1/mm].

    Boussinesq's solution, Johnson, Contact Mechanics, equation 3.18, doi:10.1017/CBO9781139171731,
    with ``(R - z)/(r^2 R)`` written as ``1/(R (R + z))``, which does not cancel near the axis.
    """
    # with E* = 1 the shear modulus is (1 - nu)/2
    scale = 1.0 / (2.0 * math.pi * (1.0 - poisson_ratio))
    R = np.sqrt(x**2 + y**2 + z**2)
    radial = scale * (z / R**3 - (1.0 - 2.0 * poisson_ratio) / (R * (R + z)))
    axial = scale * (z**2 / R**3 + 2.0 * (1.0 - poisson_ratio) / R)
    return radial * x, radial * y, axial


def side_traction(
    x: FloatArray, y: FloatArray, z: FloatArray, poisson_ratio: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Stresses xx, xy and xz there [1/mm^2]: the traction on a side whose normal is x.

    Johnson, equation 3.19 in Cartesian components, again with R + z in place of r^2. They do not
    depend on the modulus, and stay finite for nu = 1/2.
    """
    share = 1.0 - 2.0 * poisson_ratio
    R = np.sqrt(x**2 + y**2 + z**2)
    inner = share / (R * (R + z))
    shared = -3.0 * z / R**5 + share * (2.0 * R + z) / (R**3 * (R + z) ** 2)
    normal = share * z / R**3 - inner + x**2 * shared
    half = 0.5 / math.pi
    return half * normal, half * x * y * shared, half * -3.0 * x * z**2 / R**5
