"""Image of a surface of caps, seen from above at an angle."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from metafem.caps import SPHERE, Cap
from metafem.drawing import FloatArray, spacing

# The pixels of a picture need single precision only.
Single = NDArray[np.float32]

# Direction of view: rotation about the normal, and elevation above the base plane.
TURN, RISE = math.radians(30.0), math.radians(38.0)

# Direction towards the light, which comes from the left, the front and above; fraction of ambient light.
LIGHT, AMBIENT = np.array([-0.5, -0.35, 0.8]), 0.4

# Number of pixels across; number of samples per pixel along each direction.
PIXELS, SAMPLES = 700, 2

# Largest drawn height of exaggerated summits, over the distance between summits; possible factors of the
# exaggeration.
TALL, FACTORS = 0.45, (1, 2, 3, 5, 10, 20, 50, 100, 200, 500, 1000)

# Drawn thickness of the block over its drawn width; brightness of its top, left and right faces.
SIDE, BASE_TONE, LEFT_TONE, RIGHT_TONE = 0.03, 0.97, 0.72, 0.6


def turned(position: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the coordinates of points (..., 2) [mm] to the right and away from the viewer, (...) each."""
    x, y = position[..., 0], position[..., 1]
    return x * math.cos(TURN) + y * math.sin(TURN), y * math.cos(TURN) - x * math.sin(TURN)


def projected(position: FloatArray, height: float = 0.0) -> FloatArray:
    """Return the picture coordinates (..., 2) [mm] of points at a height above `position` (..., 2) [mm]."""
    right, away = turned(position)
    return np.stack([right, away * math.sin(RISE) + height * math.cos(RISE)], axis=-1)


def relief(
    position: FloatArray,
    height: FloatArray,
    radius: FloatArray,
    colour: FloatArray,
    corners: FloatArray,
    cap: Cap = SPHERE,
) -> tuple[FloatArray, tuple[float, float, float, float], int]:
    """Draw caps of a shape and of colours (n, 4) on the rectangle between two corners (2, 2) [mm].

    Return three values: the image (rows, columns, 4), with the lowest row first and transparent outside the
    block; the left, right, lower and upper edges of the image in the plane of projection [mm]; and the
    factor by which the heights are exaggerated.
    """
    ideal = TALL * spacing(position) / max(float(height.max()), 1e-300)
    factor = max(each for each in FACTORS if each <= max(1.0, ideal))
    right, away = turned(
        np.array([[x, y] for x in (corners[0, 0], corners[1, 0]) for y in (corners[0, 1], corners[1, 1])])
    )
    step = float(np.ptp(right)) / (PIXELS * SAMPLES)
    u = np.arange(right.min() + 0.5 * step, right.max(), step)
    v = np.arange(away.min() + 0.5 * step, away.max(), step)
    z, owner = _field(u, v, position, factor * height, radius, factor, cap)
    inside = _inside(u, v, corners)
    up = np.where(inside, (v[:, None] * math.sin(RISE)).astype(np.float32) + z * math.cos(RISE), -np.inf)
    top = np.maximum.accumulate(up, axis=0)
    side = SIDE * float(np.ptp(right))
    rows = np.arange(float(up[inside].min()) - side, float(up.max()) + step, step)
    image = np.zeros((len(rows), len(u), 4), np.float32)
    # the visible point in each column at each height of the picture: the first point that reaches this height
    seen = np.stack([np.searchsorted(column, rows) for column in top.T], axis=1)
    front = top[inside.argmax(axis=0), np.arange(len(u))]
    hit = (rows[:, None] >= front) & (seen < len(v)) & np.isfinite(front)
    column = np.broadcast_to(np.arange(len(u)), hit.shape)[hit]
    tone = np.append(colour[:, :3], [[BASE_TONE] * 3], axis=0).astype(np.float32)
    image[hit, :3] = tone[owner[seen[hit], column]] * _shade(z, step)[seen[hit], column, None]
    wall = (rows[:, None] < front) & (rows[:, None] >= front - side)
    corner = float(right[2])  # the front corner: largest x, smallest y
    image[wall, :3] = np.broadcast_to(np.where(u < corner, LEFT_TONE, RIGHT_TONE), wall.shape)[wall][:, None]
    image[hit | wall, 3] = 1.0
    extent = (float(u[0]), float(u[-1]), float(rows[0]), float(rows[-1]))
    return _averaged(image), extent, factor


def _field(
    u: FloatArray,
    v: FloatArray,
    position: FloatArray,
    top: FloatArray,
    radius: FloatArray,
    factor: int,
    cap: Cap,
) -> tuple[Single, NDArray[np.int32]]:
    """Return the drawn heights on the grid (v, u) [mm], and the index of the cap at each point, or -1."""
    z, owner = np.zeros((len(v), len(u)), np.float32), np.full((len(v), len(u)), -1, np.int32)
    right, away = turned(position)
    most = cap.tallest(radius)
    for i in np.flatnonzero(top > 0.0):
        drop = np.minimum(top[i : i + 1] / factor, most[i])
        foot = float(cap.at([i]).foot_radius(drop, radius[i : i + 1])[0])
        a, b = np.searchsorted(v, (away[i] - foot, away[i] + foot))
        c, d = np.searchsorted(u, (right[i] - foot, right[i] + foot))
        square = (v[a:b, None] - away[i]) ** 2 + (u[c:d] - right[i]) ** 2
        own = top[i] - factor * cap.one(int(i)).depth_at(np.sqrt(square), radius[i])
        higher = (square < foot**2) & (own > z[a:b, c:d])
        z[a:b, c:d][higher] = own[higher]
        owner[a:b, c:d][higher] = i
    return z, owner


def _shade(z: Single, step: float) -> FloatArray:
    """Return the brightness of each point, relative to that of the base plane."""
    along, across = np.gradient(z, step)
    light = [float(part) for part in LIGHT / np.linalg.norm(LIGHT)]
    lit = np.maximum(light[2] - across * light[0] - along * light[1], 0.0)
    lit /= np.sqrt(1.0 + along**2 + across**2)
    return np.asarray(AMBIENT + (1.0 - AMBIENT) * lit / light[2])


def _inside(u: FloatArray, v: FloatArray, corners: FloatArray) -> NDArray[np.bool_]:
    x = u * math.cos(TURN) - v[:, None] * math.sin(TURN)
    y = u * math.sin(TURN) + v[:, None] * math.cos(TURN)
    (left, front), (right, back) = corners
    return np.asarray((x >= left) & (x <= right) & (y >= front) & (y <= back))


def _averaged(image: Single) -> FloatArray:
    """Return the image with each square of samples averaged to one pixel."""
    rows, columns = (size - size % SAMPLES for size in image.shape[:2])
    image[..., :3] *= image[..., 3:]
    parts = image[:rows, :columns].reshape(rows // SAMPLES, SAMPLES, columns // SAMPLES, SAMPLES, 4)
    mean = parts.mean(axis=(1, 3))
    mean[..., :3] /= np.maximum(mean[..., 3:], 1e-9)
    return np.asarray(mean.clip(0.0, 1.0))
