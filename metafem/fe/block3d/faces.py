"""The half-space's field of a load on the sides and the base of a quarter of the block."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import scipy.sparse as sp

from metafem._validate import FloatArray
from metafem.fe.block3d.boussinesq import Vector, displacement, traction
from metafem.fe.block3d.line_elements import LineElements


@dataclass(frozen=True, eq=False)
class Face:
    """Gauss points of a face: positions (q, 3), weights (3q,) and interpolation (3q, nodal values)."""

    normal: int
    point: FloatArray
    weight: FloatArray
    interpolation: Any

    @classmethod
    def of(cls, axes: tuple[LineElements, ...], normal: int) -> Face:
        """Return the face at the far end of axis `normal`."""
        end = [np.array([axis.node[-1]]) for axis in axes]
        positions = [end[k] if k == normal else axis.quadrature[0] for k, axis in enumerate(axes)]
        weights = [np.ones(1) if k == normal else axis.quadrature[1] for k, axis in enumerate(axes)]
        shapes = [axis.at(position) for axis, position in zip(axes, positions, strict=True)]
        scalar = sp.kron(sp.kron(shapes[0], shapes[1]), shapes[2])
        return cls(
            normal,
            np.stack(np.meshgrid(*positions, indexing="ij"), axis=-1).reshape(-1, 3),
            np.tile(np.einsum("i,j,k->ijk", *weights).ravel(), 3),
            sp.block_diag([scalar] * 3, format="csr"),
        )

    def displacement(self, source: FloatArray, parity: tuple[int, int], poisson_ratio: float) -> FloatArray:
        """Half-space's displacement at the Gauss points, (3q, loads)."""
        return mirrored(partial(displacement, poisson_ratio=poisson_ratio), self.point, source, parity)

    def traction(self, source: FloatArray, parity: tuple[int, int], poisson_ratio: float) -> FloatArray:
        """Half-space's traction at the Gauss points, (3q, loads)."""
        return mirrored(
            partial(traction, normal=self.normal, poisson_ratio=poisson_ratio), self.point, source, parity
        )


def mirrored(
    field: Callable[[FloatArray, FloatArray, FloatArray], Vector],
    point: FloatArray,
    source: FloatArray,
    parity: tuple[int, int],
) -> FloatArray:
    """Field at points (q, 3) of loads at sources (m, 2) with their mirror images, (3q, m).

    `parity` is the sign of an image in the plane x = 0 and in y = 0.
    """
    total = np.zeros((3 * len(point), len(source)))
    x, y, z = point.T[:, :, None]
    for mirror in product((1, -1), repeat=2):
        sign = math.prod(m for m, p in zip(mirror, parity, strict=True) if p < 0)
        position = source * mirror
        total += sign * np.concatenate(field(x - position[:, 0], y - position[:, 1], z))
    return total
