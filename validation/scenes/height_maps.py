"""Height maps of made surfaces: spherical caps, roughness, noise, tilt, bow and holes, all known."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.surface import Surface

# Standard deviation of a normal roughness over its arithmetic mean Sa.
SD_OF_SA = math.sqrt(0.5 * math.pi)


@dataclass(frozen=True)
class Roughness:
    """Gaussian roughness of arithmetic mean `sa` [mm] and covariance ``sd^2 exp(-r^2/length^2)`` [mm]."""

    sa: float = 1.2e-3
    length: float = 8e-3

    @property
    def sd(self) -> float:
        """Standard deviation [mm]."""
        return SD_OF_SA * self.sa

    def drawn(self, shape: tuple[int, int], pixel: float, rng: np.random.Generator) -> np.ndarray:
        """Return the roughness on pixels: white noise under a Gaussian of the s.d. length / 2."""
        from scipy.ndimage import gaussian_filter1d

        field = rng.standard_normal(shape, np.float32)
        if not self.sa:
            return 0.0 * field
        width = 0.5 * self.length / pixel
        for axis in (0, 1):
            gaussian_filter1d(field, width, axis=axis, output=field, mode="wrap")
        impulse = np.zeros(2 * math.ceil(4.0 * width) + 3)
        impulse[impulse.size // 2] = 1.0
        gain = float((gaussian_filter1d(impulse, width) ** 2).sum())
        field *= np.float32(self.sd / gain)
        return field


@dataclass(frozen=True)
class Placement:
    """How the part lies under the microscope: turned by an angle [rad], then shifted [mm]."""

    rotation: float = 0.0
    shift: tuple[float, float] = (0.0, 0.0)

    def of(self, position: FloatArray) -> FloatArray:
        """Return positions (n, 2) on the map [mm]."""
        c, s = math.cos(self.rotation), math.sin(self.rotation)
        return position @ np.array([[c, s], [-s, c]]) + np.array(self.shift)


def height_map(
    surface: Surface,
    shape: tuple[int, int],
    pixel: float = 2e-3,
    *,
    placement: Placement | None = None,
    roughness: Roughness | None = None,
    noise: float = 0.3e-3,
    tilt: tuple[float, float] = (2e-3, -1e-3),
    bow: tuple[float, float, float] = (3e-4, 1e-4, -2e-4),
    steepest: float | None = 1.2,
    rng: int | np.random.Generator = 0,
) -> np.ndarray:
    """Return the map of a surface, (rows, columns) of single precision [mm].

    x runs along the columns, y upwards: the last row is at the bottom, and the centre of its first pixel is
    half a pixel from the origin. `tilt` holds the slopes along x and y, `bow` the coefficients of x², xy and
    y² [1/mm], about the centre of the map. Pixels are nan where the flank of a cap is steeper than
    `steepest`, with a ragged edge; None: nowhere.
    """
    from scipy.ndimage import gaussian_filter

    generator = check.generator(rng)
    rows, columns = shape
    x = pixel * (np.arange(columns) + 0.5)
    y = pixel * (rows - np.arange(rows) - 0.5)
    z = (roughness or Roughness()).drawn(shape, pixel, generator)
    place = placement or Placement(shift=(0.5 * pixel * columns, 0.5 * pixel * rows))
    for (cx, cy), height, radius in zip(
        place.of(surface.position).tolist(), surface.height.tolist(), surface.radius.tolist(), strict=True
    ):
        foot = math.sqrt(max(height * (2.0 * radius - height), 0.0))
        first, last = np.searchsorted(x, (cx - foot, cx + foot))
        top, bottom = np.searchsorted(-y, (-cy - foot, -cy + foot))
        square = (x[first:last] - cx) ** 2 + (y[top:bottom, None] - cy) ** 2
        cap = np.sqrt(np.maximum(radius**2 - square, (radius - height) ** 2)) - (radius - height)
        window = z[top:bottom, first:last]
        window += cap.astype(np.float32)
        if steepest is not None:
            slope = np.sqrt(square / np.maximum(radius**2 - square, (radius - height) ** 2))
            ragged = gaussian_filter(generator.standard_normal(window.shape), 2.0)
            window[(cap > 0.0) & (slope > steepest * (1.0 + ragged))] = np.nan
    u, v = (x - x.mean()), (y - y.mean())[:, None]
    for i in range(0, rows, 512):  # in bands: a whole map in double precision is large
        band = slice(i, min(i + 512, rows))
        w = v[band]
        z[band] += tilt[0] * u + tilt[1] * w + bow[0] * u**2 + bow[1] * u * w + bow[2] * w**2
        z[band] += np.float32(noise) * generator.standard_normal(z[band].shape, np.float32)
    return z
