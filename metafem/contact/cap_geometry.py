"""Geometry of caps: the spheres of most laws, or surfaces of revolution of any profile."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import elementwise

from metafem._validate import FloatArray
from metafem.errors import refuse_if

Values = FloatArray | float

# Distance of neighbours on a ring of a mesh: 60 degrees on the ring of six points, an arc of pi/3 spacings.
RING_ARC = math.pi / 3.0

# Number of points along a meridian for its length and curvature, and number of ring spacings at which the
# chord error is computed.
POINTS, SPACINGS = 4097, 129

# Nodes of the quadrature of a cap's volume: 1e-7 for tables, rounding for smooth profiles.
NODES = 64


def foot_radius(height: Values, radius: Values) -> FloatArray:
    """Radius of the circle in which a cap of height h <= R meets its base plane, sqrt(h (2 R - h)) [mm]."""
    return np.asarray(np.sqrt(height * (2.0 * radius - height)))


def sphere_profile(r: FloatArray, radius: Values) -> FloatArray:
    """Depth R - sqrt(R^2 - r^2) of a sphere below its summit at radii r <= R [mm], without cancellation."""
    return np.asarray(r**2 / (radius + np.sqrt((radius - r) * (radius + r))))


class Spheres:
    """Spherical caps of heights h <= R and radii R, (n,) [mm], on their base plane."""

    def tallest(self, radius: FloatArray) -> FloatArray:
        """Largest height of a cap, R [mm]."""
        return radius

    def foot_radius(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Radius of the circle in which a cap meets its base plane [mm]."""
        return foot_radius(height, radius)

    def depth_at(self, distance: FloatArray, radius: float) -> FloatArray:
        """Depth below the summit [mm]; beyond the equator, the depth of the equator."""
        return np.asarray(radius - np.sqrt(np.maximum(radius**2 - distance**2, 0.0)))

    def volume(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Volume pi h^2 (3 R - h)/3 [mm^3]."""
        return np.asarray(math.pi * height**2 * (3.0 * radius - height) / 3.0)

    def largest_area(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Area 2 pi R h [mm^2]."""
        return np.asarray(2.0 * math.pi * radius * height)

    def ring_count(self, height: FloatArray, radius: FloatArray, chord_error: float) -> FloatArray:
        """Number of rings for which the triangles of a mesh are within the chord error [mm] of the spheres.

        The rings of 6, 12, 18, ... points are at equal distances along the meridian.
        Neighbouring rings are at most D apart along a meridian and pi/3 D along a ring, so no triangle has a
        circumradius above that of the right triangle of these sides, which lies
        ``(1 + (pi/3)^2) D^2 / (8 R)`` below the sphere.
        """
        step = np.sqrt(8.0 * chord_error / ((1.0 + RING_ARC**2) * radius))
        return np.asarray(self._opening(height, radius) / step)

    def rings(self, height: FloatArray, radius: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
        """Distances of the summit and the rings from the axis, and their heights, at equal polar angles."""
        polar = self._opening(height, radius)[:, None] * np.arange(count + 1) / count
        across = radius[:, None] * np.sin(polar)
        z = height[:, None] - 2.0 * radius[:, None] * np.sin(0.5 * polar) ** 2
        across[:, -1] = foot_radius(height, radius)
        z[:, -1] = 0.0
        return across, z

    def _opening(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Polar angles of rims, from ``h = R (1 - cos) = 2 R sin^2(angle/2)``."""
        return np.asarray(2.0 * np.arcsin(np.sqrt(0.5 * height / radius)))


SPHERES = Spheres()


@dataclass(frozen=True)
class ProfileCaps:
    """Caps with any increasing profile f(rho) from the summit down; same methods as `Spheres`.

    `profile` returns depths at distances for the scale 1. If `scaled`, lengths scale with R; otherwise all
    caps have the same profile. It ends at `extent` [mm], if that is given.
    """

    profile: Callable[[FloatArray], FloatArray]
    scaled: bool
    extent: float = math.inf

    def tallest(self, radius: FloatArray) -> FloatArray:
        """Largest height of a cap [mm]: the depth at the extent."""
        if math.isinf(self.extent):
            return np.full_like(radius, math.inf)
        return np.asarray(self._scale(radius) * float(self.profile(np.array(self.extent))))

    def foot_radius(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Distance at which the depth is the height [mm]; raises InvalidInput beyond the extent."""
        scale = self._scale(radius)
        return np.asarray(scale * self._foot(np.asarray(height / scale)))

    def depth_at(self, distance: FloatArray, radius: float) -> FloatArray:
        """Depth below the summit [mm]."""
        scale = radius if self.scaled else 1.0
        return np.asarray(scale * self.profile(distance / scale))

    def volume(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Volume 2 pi int rho (h - f) drho [mm^3], by quadrature."""
        node, weight = np.polynomial.legendre.leggauss(NODES)
        scale = self._scale(radius)[:, None]
        foot = self.foot_radius(height, radius)[:, None]
        rho = 0.5 * foot * (node + 1.0)
        inside = height[:, None] - scale * self.profile(rho / scale)
        return np.asarray(math.pi * foot[:, 0] * ((rho * inside) @ weight))

    def largest_area(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Upper bound of the area of a cap: its foot and a cylinder around it [mm^2]."""
        foot = self.foot_radius(height, radius)
        return np.asarray(math.pi * foot * (foot + 2.0 * height))

    def ring_count(self, height: FloatArray, radius: FloatArray, chord_error: float) -> FloatArray:
        """Number of rings for which the triangles are within the chord error [mm] of the caps."""
        scale = self._scale(radius)
        across, along, foot = self._meridian(height / scale)
        spacing, error = self._chord_errors(across, along)
        wanted = np.log(chord_error / scale)
        found = np.interp(wanted, np.log(error), np.log(spacing))
        found += np.minimum(wanted - math.log(error[0]), 0.0)  # finer: no error grows slower than linearly
        return np.asarray(np.interp(foot, across, along) / np.exp(found))

    def rings(self, height: FloatArray, radius: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
        """Distances of the summit and the rings from the axis, and their heights, (n, count + 1) [mm]."""
        scale = self._scale(radius)[:, None]
        across, along, foot = self._meridian(height / scale[:, 0])
        length = np.interp(foot, across, along)
        x = np.interp(length[:, None] * np.arange(count + 1) / count, along, across)
        x[:, -1] = foot
        z = height[:, None] - scale * self.profile(x)
        z[:, -1] = 0.0
        return np.asarray(scale * x), np.asarray(z)

    def _scale(self, radius: FloatArray) -> FloatArray:
        return np.asarray(radius) if self.scaled else np.ones_like(radius)

    def _foot(self, height: FloatArray) -> FloatArray:
        """Distance at which the depth is the height, to rounding; all divided by the scale."""
        most = float(self.profile(np.array(self.extent))) if math.isfinite(self.extent) else math.inf
        refuse_if(
            (height > most).any(),
            f"contact.profile: the profile ends {most:.4g} mm below the summit, at its extent of "
            f"{self.extent:g} mm; a cap of the height {height.max():.4g} mm needs a wider profile",
        )

        def missing(distance: FloatArray, height: FloatArray) -> FloatArray:
            return self.profile(distance) - height

        wide = np.minimum(height, self.extent)
        while (short := missing(wide, height) < 0.0).any():
            wide = np.where(short, np.minimum(2.0 * wide, self.extent), wide)
        found = elementwise.find_root(missing, (np.zeros_like(wide), wide), args=(height,))
        return np.asarray(found.x)

    def _meridian(self, height: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Distances from the axis and lengths from the summit along a meridian, and all feet.

        The meridian ends at the foot of the tallest cap. All lengths are divided by the scale.
        """
        foot = self._foot(height)
        across = foot.max() * np.linspace(0.0, 1.0, POINTS)
        steps = np.hypot(np.diff(across), np.diff(self.profile(across)))
        return across, np.concatenate([[0.0], np.cumsum(steps)]), foot

    def _chord_errors(self, across: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Spacings of rings along a meridian, and the largest chord error with each; divided by the scale.

        A triangle lies within ``D^2/8 (k1 + (pi/3)^2 k2)`` of the cap, with the curvatures k1 along the
        meridian and k2 across it. Where the curvature at the summit is infinite, rings of the spacing D begin
        at D, and k1 is taken from D/4 on.
        """
        angle = np.arctan(np.gradient(self.profile(across), across))
        k1 = np.abs(np.gradient(angle, along))
        k2 = np.abs(np.sin(angle)) / np.maximum(across, across[1])
        most1, most2 = (np.maximum.accumulate(k[::-1])[::-1] for k in (k1, k2))
        spacing = along[-1] * np.geomspace(4.0 / POINTS, 1.0, SPACINGS)
        at_summit, outside = np.searchsorted(along, 0.25 * spacing), np.searchsorted(along, spacing)
        bend = most1[at_summit] + RING_ARC**2 * most2[outside]
        return spacing, np.maximum.accumulate(spacing**2 / 8.0 * bend)


CapShape = Spheres | ProfileCaps
