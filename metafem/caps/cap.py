"""Geometry of caps: surfaces of revolution with any increasing profile."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Any, ClassVar

import numpy as np

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


class Cap(ABC):
    """Shape of the caps of a surface: a profile f(rho) below the summit, which increases with rho.

    If `scaled` is true, all lengths are proportional to the radius R of the asperity; otherwise all caps have
    the same profile, whatever R is. A profile ends at its `extent`, divided by R if it is scaled.
    """

    scaled: ClassVar[bool] = True

    @property
    def extent(self) -> float:
        """Distance from the axis at which the profile ends; infinite if it has no end."""
        return math.inf

    @abstractmethod
    def unit_profile(self, rho: FloatArray) -> FloatArray:
        """Return the depth f at distances rho from the axis, for R = 1."""

    @abstractmethod
    def summit_radius(self, radius: FloatArray) -> FloatArray:
        """Return the radii of curvature of summits [mm]; raise InvalidInput if a summit has none."""

    def at(self, some: Any) -> Cap:
        """Return the caps of some asperities, given by indices or by a mask: here the cap itself."""
        return self

    def one(self, i: int) -> Cap:
        """Return the cap of asperity i: here the cap itself."""
        return self

    def tallest(self, radius: FloatArray) -> FloatArray:
        """Return the largest possible heights of caps [mm], (n,): the depth at the extent."""
        if math.isinf(self.extent):
            return np.full_like(radius, math.inf)
        return np.asarray(self._scale(radius) * float(self.unit_profile(np.array(self.extent))))

    def foot_radius(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the distances [mm] at which the depth is the height, if these are within the extent."""
        scale = self._scale(radius)
        return np.asarray(scale * self._foot(np.asarray(height / scale)))

    def depth_at(self, distance: FloatArray, radius: float) -> FloatArray:
        """Return the depth below the summit [mm] at distances from the axis."""
        scale = radius if self.scaled else 1.0
        return np.asarray(scale * self.unit_profile(distance / scale))

    def volume(self, height: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the volumes 2 pi int rho (h - f) drho [mm^3], (n,), by quadrature."""
        node, weight = np.polynomial.legendre.leggauss(NODES)
        scale = self._scale(radius)[:, None]
        foot = self.foot_radius(height, radius)[:, None]
        rho = 0.5 * foot * (node + 1.0)
        inside = height[:, None] - scale * self.unit_profile(rho / scale)
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
        z = height[:, None] - scale * self.unit_profile(x)
        z[:, -1] = 0.0
        return np.asarray(scale * x), np.asarray(z)

    def _scale(self, radius: FloatArray) -> FloatArray:
        return np.asarray(radius) if self.scaled else np.ones_like(radius)

    def _foot(self, height: FloatArray) -> FloatArray:
        """Return the distances at which the depth is the height, to rounding; all lengths over the scale."""
        most = float(self.unit_profile(np.array(self.extent))) if math.isfinite(self.extent) else math.inf
        refuse_if(
            (height > most).any(),
            f"cap.profile: the profile ends {most:.4g} mm below the summit, at its extent of "
            f"{self.extent:g} mm; a cap of the height {height.max():.4g} mm needs a wider profile",
        )

        def missing(distance: FloatArray, height: FloatArray) -> FloatArray:
            return self.unit_profile(distance) - height

        wide = np.minimum(height, self.extent)
        while (short := missing(wide, height) < 0.0).any():
            wide = np.where(short, np.minimum(2.0 * wide, self.extent), wide)
        from scipy.optimize import elementwise  # loaded by no surface whose caps have a closed form

        found = elementwise.find_root(missing, (np.zeros_like(wide), wide), args=(height,))
        return np.asarray(found.x)

    def _meridian(self, height: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return distances from the axis and arc lengths along a meridian, and the foot radii of all caps.

        The meridian ends at the foot of the tallest cap. All lengths are divided by the scale.
        """
        foot = self._foot(height)
        across = foot.max() * np.linspace(0.0, 1.0, POINTS)
        steps = np.hypot(np.diff(across), np.diff(self.unit_profile(across)))
        return across, np.concatenate([[0.0], np.cumsum(steps)]), foot

    def _chord_errors(self, across: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return spacings of rings along a meridian and the largest chord error for each, over the scale.

        With the spacing D, a triangle lies within ``D^2/8 (k1 + (pi/3)^2 k2)`` of the cap, where k1 is the
        curvature along the meridian and k2 the curvature across it. The curvature may be infinite at the
        summit: k1 is its largest value beyond the arc length D/4, and k2 that beyond the first ring, at D.
        """
        angle = np.arctan(np.gradient(self.unit_profile(across), across))
        k1 = np.abs(np.gradient(angle, along))
        k2 = np.abs(np.sin(angle)) / np.maximum(across, across[1])
        most1, most2 = (np.maximum.accumulate(k[::-1])[::-1] for k in (k1, k2))
        spacing = along[-1] * np.geomspace(4.0 / POINTS, 1.0, SPACINGS)
        at_summit, outside = np.searchsorted(along, 0.25 * spacing), np.searchsorted(along, spacing)
        bend = most1[at_summit] + RING_ARC**2 * most2[outside]
        return spacing, np.maximum.accumulate(spacing**2 / 8.0 * bend)
