"""Triangles of spherical caps, between rings of points."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact.cap_geometry import foot_radius

# Distance of neighbours on a ring: 60 degrees in a ring of six points, an arc of pi/3 ring spacings.
_RING_ARC = math.pi / 3.0

# One ring would make a pyramid of the flattest caps.
_FEWEST = 2


def ring_count(height: FloatArray, radius: FloatArray, chord_error: float) -> IntArray:
    """Return numbers of rings (n,) that keep triangles within the chord error [mm] of the spheres.

    Neighbouring rings are at most D apart along a meridian and pi/3 D along a ring, so no triangle has a
    circumradius above that of the right triangle of these sides, which lies ``(1 + (pi/3)^2) D^2 / (8 R)``
    below the sphere.
    """
    step = np.sqrt(8.0 * chord_error / ((1.0 + _RING_ARC**2) * radius))
    return np.maximum(_FEWEST, np.ceil(_opening(height, radius) / step)).astype(np.int64)


def cap_vertices(height: FloatArray, radius: FloatArray, rings: int) -> FloatArray:
    """Return vertices (n, m, 3) [mm] of caps with their summits above the origin.

    The summit and rings of 6, 12, 18, ... points lie on the sphere, at equal polar angles down to the
    base plane z = 0. The last ring is the rim: the last ``6 rings`` points, counterclockwise.
    """
    size = np.arange(rings + 1) * 6
    size[0] = 1
    ring = np.repeat(np.arange(rings + 1), size)
    place = np.arange(len(ring)) - np.repeat(np.cumsum(size) - size, size)
    turn = 2.0 * math.pi * place / size[ring]
    polar = _opening(height, radius)[:, None] * np.arange(rings + 1) / rings
    across = radius[:, None] * np.sin(polar)
    z = height[:, None] - 2.0 * radius[:, None] * np.sin(0.5 * polar) ** 2
    across[:, -1] = foot_radius(height, radius)
    z[:, -1] = 0.0
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


def _opening(height: FloatArray, radius: FloatArray) -> FloatArray:
    """Return the polar angles of rims, from ``h = R (1 - cos) = 2 R sin^2(angle/2)``."""
    opening: FloatArray = 2.0 * np.arcsin(np.sqrt(0.5 * height / radius))
    return opening
