"""Closed triangle meshes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from metafem._validate import FloatArray, IntArray

# Number of faces that are processed at a time: about ten megabytes.
_AT_A_TIME = 1 << 16


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles that bound a solid."""

    vertices: FloatArray  # (n, 3) [mm]
    faces: IntArray  # (m, 3), counterclockwise, seen from outside

    def corners(self) -> Iterator[FloatArray]:
        """Yield the corners of faces, (k, 3 corners, 3) [mm], some at a time."""
        for start in range(0, len(self.faces), _AT_A_TIME):
            yield self.vertices[self.faces[start : start + _AT_A_TIME]]

    @property
    def volume(self) -> float:
        """Enclosed volume by the divergence theorem, the sum of ``(a, b, c)/6`` over the faces [mm^3]."""
        return sum(
            float(np.einsum("ij,ij->", abc[:, 0], np.cross(abc[:, 1], abc[:, 2]))) / 6.0
            for abc in self.corners()
        )

    @property
    def closed(self) -> bool:
        """Whether each edge belongs to two faces that traverse it in opposite directions."""
        start, end = self.faces.ravel(), np.roll(self.faces, -1, axis=1).ravel()
        forth = np.sort(start * len(self.vertices) + end)
        back = np.sort(end * len(self.vertices) + start)
        return bool((forth == back).all() and (forth[1:] > forth[:-1]).all() and (start != end).all())


def mirrored(points: FloatArray) -> FloatArray:
    """Return points of the part (n, 2) or (n, 3) as seen from the open face of the mould: x -> -x [mm].

    The part lies face down on the mould, as on a page that is turned over.
    """
    result = np.array(points)
    result[:, 0] = 0.0 - result[:, 0]  # -x is -0.0 on the axis
    return result
