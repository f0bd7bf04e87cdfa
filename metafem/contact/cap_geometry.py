"""Geometry of caps: spheres for most contact laws, or surfaces of revolution with any profile."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import elementwise

from metafem._validate import FloatArray
from metafem.errors import refuse_if

Values = FloatArray | float

# Distance of neighbouring points on a ring of a mesh, over the spacing of the rings. The six points on the
# first ring are 60 degrees apart.
RING_ARC = math.pi / 3.0

# Number of points along a meridian at which its length and curvature are computed, and number of ring
# spacings for which the chord error is computed.
POINTS, SPACINGS = 4097, 129

# Number of quadrature nodes for the volume of a cap. The relative error is 1e-7 for tables, and rounding for
# smooth profiles.
NODES = 64


def foot_radius(height: Values, radius: Values) -> FloatArray:
    """Return the foot radius of a cap of height h <= R at the base plane, sqrt(h (2 R - h)) [mm]."""
    return np.asarray(np.sqrt(height * (2.0 * radius - height)))


def sphere_profile(r: FloatArray, radius: Values) -> FloatArray:
    """Return the depth R - sqrt(R^2 - r^2) [mm] below a sphere's summit at r <= R, without cancellation."""
    return np.asarray(r**2 / (radius + np.sqrt((radius - r) * (radius + r))))


class Spheres:
    """Geometry of spherical caps on a base plane, with heights h <= R and radii R, (n,) [mm]."""

    def tallest(self, radius: FloatArray) -> FloatArray:
        """Return the largest possible heights of caps, R [mm], (n,)."""
        return radius

    def foot_radius(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the foot radii at the base plane [mm], (n,)."""
        return foot_radius(height, radius)

    def depth_at(self, distance: FloatArray, radius: float) -> FloatArray:
        """Return the depth below the summit [mm] at distances from the axis; beyond the equator, R."""
        return np.asarray(radius - np.sqrt(np.maximum(radius**2 - distance**2, 0.0)))

    def volume(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the volumes pi h^2 (3 R - h)/3 [mm^3], (n,)."""
        return np.asarray(math.pi * height**2 * (3.0 * radius - height) / 3.0)

    def largest_area(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the areas of the caps, 2 pi R h [mm^2], (n,)."""
        return np.asarray(2.0 * math.pi * radius * height)

    def ring_count(self, height: FloatArray, radius: FloatArray, chord_error: float) -> FloatArray:
        """Return how many rings, (n,), keep the triangles within the chord error [mm] of the spheres.

        Rings of 6, 12, 18, ... points lie at equal distances D along the meridian. Neighbouring points are at
        most pi/3 D apart along a ring. The circumradius of a triangle is therefore at most that of a right
        triangle with the sides D and pi/3 D, which lies up to ``(1 + (pi/3)^2) D^2 / (8 R)`` below the
        sphere.
        """
        step = np.sqrt(8.0 * chord_error / ((1.0 + RING_ARC**2) * radius))
        return np.asarray(self._opening(height, radius) / step)

    def rings(self, height: FloatArray, radius: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the distances of summit and rings from the axis, and their heights, (n, count + 1) [mm]."""
        polar = self._opening(height, radius)[:, None] * np.arange(count + 1) / count
        across = radius[:, None] * np.sin(polar)
        z = height[:, None] - 2.0 * radius[:, None] * np.sin(0.5 * polar) ** 2
        across[:, -1] = foot_radius(height, radius)
        z[:, -1] = 0.0
        return across, z

    def _opening(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the polar angles of the feet [rad], from ``h = R (1 - cos(angle)) = 2 R sin^2(angle/2)``."""
        return np.asarray(2.0 * np.arcsin(np.sqrt(0.5 * height / radius)))


SPHERES = Spheres()


@dataclass(frozen=True)
class ProfileCaps:
    """Geometry of caps with any increasing profile; it has the same methods as `Spheres`.

    `profile` returns the depth f below the summit at distances rho from the axis. If `scaled` is true, this
    is the profile for R = 1 and all lengths are proportional to R; otherwise all caps have the same profile.
    The profile ends at `extent` [mm]; default: it has no end.
    """

    profile: Callable[[FloatArray], FloatArray]
    scaled: bool
    extent: float = math.inf

    def tallest(self, radius: FloatArray) -> FloatArray:
        """Return the largest possible heights of caps [mm], (n,): the depth at the extent."""
        if math.isinf(self.extent):
            return np.full_like(radius, math.inf)
        return np.asarray(self._scale(radius) * float(self.profile(np.array(self.extent))))

    def foot_radius(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the distances [mm] at which the depth is the height, if these are within the extent."""
        scale = self._scale(radius)
        return np.asarray(scale * self._foot(np.asarray(height / scale)))

    def depth_at(self, distance: FloatArray, radius: float) -> FloatArray:
        """Return the depth below the summit [mm] at distances from the axis."""
        scale = radius if self.scaled else 1.0
        return np.asarray(scale * self.profile(distance / scale))

    def volume(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the volumes 2 pi int rho (h - f) drho [mm^3], (n,), by quadrature."""
        node, weight = np.polynomial.legendre.leggauss(NODES)
        scale = self._scale(radius)[:, None]
        foot = self.foot_radius(height, radius)[:, None]
        rho = 0.5 * foot * (node + 1.0)
        inside = height[:, None] - scale * self.profile(rho / scale)
        return np.asarray(math.pi * foot[:, 0] * ((rho * inside) @ weight))

    def largest_area(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return upper bounds of the areas [mm^2], (n,): the foot plus a cylinder around the cap."""
        foot = self.foot_radius(height, radius)
        return np.asarray(math.pi * foot * (foot + 2.0 * height))

    def ring_count(self, height: FloatArray, radius: FloatArray, chord_error: float) -> FloatArray:
        """Return how many rings, (n,), keep the triangles within the chord error [mm] of the caps."""
        scale = self._scale(radius)
        across, along, foot = self._meridian(height / scale)
        spacing, error = self._chord_errors(across, along)
        wanted = np.log(chord_error / scale)
        found = np.interp(wanted, np.log(error), np.log(spacing))
        found += np.minimum(wanted - math.log(error[0]), 0.0)  # finer: the error falls at least linearly
        return np.asarray(np.interp(foot, across, along) / np.exp(found))

    def rings(self, height: FloatArray, radius: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
        """Return the distances of summit and rings from the axis, and their heights, (n, count + 1) [mm]."""
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
        """Return the distances at which the depth is the height, to rounding; all lengths over the scale."""
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
        """Return distances from the axis and arc lengths along a meridian, and the foot radii of all caps.

        The meridian ends at the foot of the tallest cap. All lengths are divided by the scale.
        """
        foot = self._foot(height)
        across = foot.max() * np.linspace(0.0, 1.0, POINTS)
        steps = np.hypot(np.diff(across), np.diff(self.profile(across)))
        return across, np.concatenate([[0.0], np.cumsum(steps)]), foot

    def _chord_errors(self, across: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return spacings of rings along a meridian and the largest chord error for each, over the scale.

        With the spacing D, a triangle lies within ``D^2/8 (k1 + (pi/3)^2 k2)`` of the cap, where k1 is the
        curvature along the meridian and k2 the curvature across it. The curvature may be infinite at the
        summit: k1 is its largest value beyond the arc length D/4, and k2 that beyond the first ring, at D.
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
