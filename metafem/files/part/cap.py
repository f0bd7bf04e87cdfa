"""Triangles of one spherical cap."""

from __future__ import annotations

import math
from functools import cache

import numpy as np

from metafem._validate import FloatArray, IntArray

# Largest depth of the triangles below the sphere, in radii: 0.2 um on the source paper's summits of
# 526 um, a quarter of the 0.9 um with which its moulds are made (doi:10.1126/science.adk4234).
CHORD_ERROR = 4e-4

# Neighbours in a ring of six points are 60 degrees apart: an arc of pi/3 ring spacings.
_RING_ARC = math.pi / 3.0


def cap_mesh(height: float, radius: float) -> tuple[FloatArray, IntArray, IntArray]:
    """Return vertices (m, 3) [mm], outward faces (k, 3) and the rim of a cap, summit over the origin.

    The summit and rings of 6, 12, 18, ... points lie on the sphere, at equal polar angles down to the
    base plane z = 0, where the last ring is the rim, counterclockwise. Neighbouring rings are at most
    D apart along a meridian and pi/3 D along a ring, so no triangle has a circumradius above that of
    the right triangle of these sides, which lies ``(1 + (pi/3)^2) D^2 / (8 R)`` below the sphere.
    """
    angle = 2.0 * math.asin(math.sqrt(0.5 * height / radius))  # h = R (1 - cos) = 2 R sin^2(angle/2)
    step = math.sqrt(8.0 * CHORD_ERROR / (1.0 + _RING_ARC**2))
    rings = max(2, math.ceil(angle / step))
    size = np.arange(rings + 1) * 6
    size[0] = 1
    ring = np.repeat(np.arange(rings + 1), size)
    place = np.arange(len(ring)) - np.repeat(np.cumsum(size) - size, size)
    turn = 2.0 * math.pi * place / size[ring]
    polar = angle * ring / rings
    across = radius * np.sin(polar)
    z = height - 2.0 * radius * np.sin(0.5 * polar) ** 2
    rim = np.flatnonzero(ring == rings)
    across[rim] = math.sqrt(height * (2.0 * radius - height))
    z[rim] = 0.0
    return np.column_stack([across * np.cos(turn), across * np.sin(turn), z]), _faces(rings), rim


@cache
def _faces(rings: int) -> IntArray:
    """Return faces of the disc of rings: between two rings, six sectors of alternating triangles."""
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
