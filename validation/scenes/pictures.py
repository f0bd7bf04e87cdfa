"""Synthetic pictures of dark contacts on a brighter ground; all lengths in pixels.

A point of the frame has the coordinates x to the right and y upwards, from its lower left corner. Row 0 of an
image is its uppermost row, so pixel (i, j) of an image with H rows is the square j < x < j + 1,
H - i - 1 < y < H - i.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtr

from metafem._validate import FloatArray

# Grey levels of a contact and of the ground, as fractions of full scale.
DARK, BRIGHT = 0.2, 0.7

# A contact is drawn where its edge is nearer than so many standard deviations of the blur: beyond it, the
# coverage is below 1e-9.
REACH = 6.0

# Quadrature nodes over a contact: at least so many, so many per pixel of its height, and so many per standard
# deviation of the blur.
NODES, PER_PIXEL, PER_BLUR = 64, 4, 4


def picture(
    shape: tuple[int, int],
    centre: ArrayLike,
    axes: ArrayLike,
    angle: ArrayLike = 0.0,
    *,
    blur: float = 1.5,
    noise: float = 0.0,
    gradient: tuple[float, float] = (0.0, 0.0),
    vignetting: float = 0.0,
    levels: tuple[float, float] = (DARK, BRIGHT),
    bits: int | None = None,
    rng: Any = 0,
) -> NDArray[Any]:
    """Draw contacts with exact areas, pi times the product of their semi-axes.

    `axes` (n, 2) holds semi-axes, or (n,) radii; `angle` (n,) the direction of the first semi-axis,
    anticlockwise from x. `blur` is the standard deviation of the optics; each pixel then averages over its
    square. The illumination changes by `gradient`, in proportion, from the left to the right edge and from
    the lower to the upper one, and is lower by `vignetting` in the corners. `noise` is the standard deviation
    of each pixel over the contrast. With `bits` the image is of integers, clipped at full scale.
    """
    dark, bright = levels
    covered = np.minimum(coverage(shape, centre, axes, angle, blur=blur), 1.0)
    image = (bright + (dark - bright) * covered) * illumination(shape, gradient, vignetting)
    if noise:
        image += noise * abs(bright - dark) * np.random.default_rng(rng).standard_normal(shape)
    if bits is None:
        return image
    largest = 2**bits - 1
    return np.clip(np.round(image * largest), 0, largest).astype(np.uint8 if bits <= 8 else np.uint16)


def illumination(
    shape: tuple[int, int], gradient: tuple[float, float] = (0.0, 0.0), vignetting: float = 0.0
) -> FloatArray:
    """Return the illumination of each pixel, 1 at the centre of the frame."""
    x = (np.arange(shape[1]) + 0.5) / shape[1] - 0.5
    y = 0.5 - (np.arange(shape[0])[:, None] + 0.5) / shape[0]
    return 1.0 + gradient[0] * x + gradient[1] * y - vignetting * 2.0 * (x**2 + y**2)


def coverage(
    shape: tuple[int, int], centre: ArrayLike, axes: ArrayLike, angle: ArrayLike = 0.0, *, blur: float = 1.5
) -> FloatArray:
    """Return how much of each pixel ellipses cover after the blur; those that overlap are added up."""
    middle = np.atleast_2d(np.asarray(centre, dtype=float))
    half = np.asarray(axes, dtype=float)
    half = np.broadcast_to(half if half.ndim == 2 else np.atleast_1d(half)[:, None], middle.shape)
    direction = np.broadcast_to(np.asarray(angle, dtype=float), len(middle))
    covered = np.zeros(shape)
    for (x, y), (a, b), phi in zip(middle, half, direction, strict=True):
        _add(covered[::-1], x, y, a, b, phi, blur)  # rows from the lower edge upwards
    return covered


def _add(covered: FloatArray, x: float, y: float, a: float, b: float, phi: float, blur: float) -> None:
    """Add one ellipse, by exact integration over x and by quadrature over y.

    At the height y + h s, |s| < 1, the ellipse covers an interval with the centre x + s k and the half-width
    (a b/h) sqrt(1 - s²), with h² = a² sin² + b² cos² and k = (a² - b²) sin cos/h. With s = -cos t,
    the integrand is smooth and periodic in t, so that equal steps converge faster than any power.
    """
    cos, sin = np.cos(phi), np.sin(phi)
    height, width = np.hypot(a * sin, b * cos), np.hypot(a * cos, b * sin)
    reach = REACH * blur + 1.0
    rows = slice(max(int(y - height - reach), 0), max(int(np.ceil(y + height + reach)), 0))
    columns = slice(max(int(x - width - reach), 0), max(int(np.ceil(x + width + reach)), 0))
    patch = covered[rows, columns]
    if not patch.size:
        return
    per_height = max(PER_PIXEL, PER_BLUR / blur if blur else 16.0)
    count = int(NODES + per_height * height)
    angle = (np.arange(count) + 0.5) * np.pi / count
    s, c = -np.cos(angle), np.sin(angle)
    weight = np.pi / count * height * c
    middle, half = x + s * (a**2 - b**2) * sin * cos / height, a * b / height * c
    left = columns.start + np.arange(patch.shape[1] + 1)
    interval = _ramp(left - (middle - half)[:, None], blur) - _ramp(left - (middle + half)[:, None], blur)
    lower = rows.start + np.arange(patch.shape[0] + 1)
    row = _step(lower[:, None] - (y + height * s), blur)
    patch += (np.diff(row, axis=0) * weight) @ np.diff(interval, axis=1)


def _step(u: FloatArray, blur: float) -> FloatArray:
    """Return the unit step after the blur."""
    return ndtr(u / blur) if blur else (u > 0.0).astype(float)


def _ramp(u: FloatArray, blur: float) -> FloatArray:
    """Return the integral of the unit step after the blur."""
    if not blur:
        return np.maximum(u, 0.0)
    return u * ndtr(u / blur) + blur * np.exp(-0.5 * (u / blur) ** 2) / np.sqrt(2.0 * np.pi)


def lattice(
    side: int, radius: float, rng: np.random.Generator, shift: float = 0.5
) -> tuple[tuple[int, int], FloatArray]:
    """Return the shape of a frame and the centres of contacts about the sites of a square lattice in it.

    The pitch over the radius is that of the paper's widest contacts, 1.5 mm/0.4 mm, and ten pixels for the
    blur of small ones.
    """
    pitch = int(3.75 * radius + 10.0)
    x, y = np.meshgrid(*[(np.arange(side) + 0.5) * pitch] * 2)
    centre = np.stack([x.ravel(), y.ravel()], axis=1) + rng.uniform(-shift, shift, (side**2, 2))
    return (side * pitch, side * pitch), centre
