"""Triangles of caps, between rings of points."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact.cap_geometry import SPHERES, CapShape

# One ring would make a pyramid of the flattest caps.
_FEWEST = 2


def ring_count(
    height: FloatArray, radius: FloatArray, chord_error: float, shape: CapShape = SPHERES
) -> IntArray:
    """Return numbers of rings (n,) that keep triangles within the chord error [mm] of the caps."""
    return np.maximum(_FEWEST, np.ceil(shape.ring_count(height, radius, chord_error))).astype(np.int64)


def cap_vertices(height: FloatArray, radius: FloatArray, rings: int, shape: CapShape = SPHERES) -> FloatArray:
    """Return vertices (n, m, 3) [mm] of caps with their summits above the origin.

    The summit and rings of 6, 12, 18, ... points lie on the cap, at equal distances along the meridian down
    to the base plane z = 0. The last ring is the rim: the last ``6 rings`` points, counterclockwise.
    """
    size = np.arange(rings + 1) * 6
    size[0] = 1
    ring = np.repeat(np.arange(rings + 1), size)
    place = np.arange(len(ring)) - np.repeat(np.cumsum(size) - size, size)
    turn = 2.0 * math.pi * place / size[ring]
    across, z = shape.rings(height, radius, rings)
    return np.stack([across[:, ring] * np.cos(turn), across[:, ring] * np.sin(turn), z[:, ring]], axis=2)


@cache
def cap_faces(rings: int) -> IntArray:
    """Return outward faces (6 rings^2, 3): six sectors of triangles between neighbouring rings."""
    faces: list[tuple[int, int, int]] = []

    def point(ring: int, place: int) -> int:
        return 1 + 3 * ring * (ring - 1) + place % (6 * ring) if ring else 0

    for ring in range(rings):
        for sector in range(6):
            inner, outer = sector * ring, sector * (ring + 1)
            for j in range(ring + 1):
                here, corner = point(ring, inner + j), point(ring + 1, outer + j + 1)
                faces.append((here, point(ring + 1, outer + j), corner))
                if j < ring:
                    faces.append((here, corner, point(ring, inner + j + 1)))
    result = np.array(faces, dtype=np.int64)
    result.flags.writeable = False
    return result
