"""Point load on the half-space for E* = 1: the closed-form part of the block's solution."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import product

import numpy as np

from metafem._validate import FloatArray

Vector = tuple[FloatArray, FloatArray, FloatArray]


def displacement(x: FloatArray, y: FloatArray, z: FloatArray, poisson_ratio: float) -> Vector:
    """Return the displacement per unit normal load [1/mm] at (x, y, z) from the load, with z >= 0.

    Boussinesq's solution: Johnson, Contact Mechanics, equation 3.18, doi:10.1017/CBO9781139171731.
    ``(R - z)/r^2`` is written as ``1/(R + z)`` to avoid cancellation near the axis.
    """
    # with E* = 1 the shear modulus is (1 - nu)/2
    scale = 1.0 / (2.0 * math.pi * (1.0 - poisson_ratio))
    R = np.sqrt(x**2 + y**2 + z**2)
    radial = scale * (z / R**3 - (1.0 - 2.0 * poisson_ratio) / (R * (R + z)))
    axial = scale * (z**2 / R**3 + 2.0 * (1.0 - poisson_ratio) / R)
    return radial * x, radial * y, axial


def traction(x: FloatArray, y: FloatArray, z: FloatArray, normal: int, poisson_ratio: float) -> Vector:
    """Return the traction per unit load [1/mm^2] at (x, y, z), on a plane whose normal is axis 0, 1 or 2.

    Johnson, equation 3.19 in Cartesian components, also written with ``1/(R + z)``. The traction does not
    depend on the modulus and is finite for nu = 1/2.
    """
    if normal == 1:
        across, along, down = traction(y, x, z, 0, poisson_ratio)
        return along, across, down
    R = np.sqrt(x**2 + y**2 + z**2)
    vertical = -1.5 / math.pi * z**2 / R**5
    if normal == 2:
        return vertical * x, vertical * y, vertical * z
    factor = 0.5 / math.pi * (1.0 - 2.0 * poisson_ratio)
    common = -1.5 / math.pi * z / R**5 + factor * (2.0 * R + z) / (R**3 * (R + z) ** 2)
    return factor * (z / R**3 - 1.0 / (R * (R + z))) + x**2 * common, x * y * common, vertical * x


def mirrored(
    field: Callable[[FloatArray, FloatArray, FloatArray], Vector],
    point: FloatArray,
    source: FloatArray,
    parity: tuple[int, int],
) -> FloatArray:
    """Return the field (3q, m) at points (q, 3) due to each of m loads (m, 2) and its mirror images.

    `parity` holds the signs of the images in the planes x = 0 and y = 0.
    """
    total = np.zeros((3 * len(point), len(source)))
    x, y, z = point.T[:, :, None]
    for mirror in product((1, -1), repeat=2):
        sign = math.prod(m for m, p in zip(mirror, parity, strict=True) if p < 0)
        position = source * mirror
        total += sign * np.concatenate(field(x - position[:, 0], y - position[:, 1], z))
    return total
