"""Maps from the reference plane of a mesh, (s, depth), to the meridian half-plane (r, z), z downwards."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.contact.cap_geometry import foot_radius
from metafem.errors import refuse_if

# Imaginary step of the derivatives: f(x + i h) = f(x) + i h f'(x) without cancellation.
STEP = 1e-30


@dataclass(frozen=True)
class Flat:
    """A body with a flat top: the map is the identity. The geometry is analytic, not interpolated."""

    def point(self, plane: FloatArray) -> FloatArray:
        """Radius and depth [mm] of points (2, ...) of the reference plane."""
        return plane

    def jacobian(self, plane: FloatArray) -> FloatArray:
        """Derivatives of (r, z) by the plane's coordinates, (2, 2, ...), exact to rounding."""
        step = STEP * np.eye(2).reshape((2, 2) + (1,) * (plane.ndim - 1))
        return np.stack([self.point(plane + 1j * each).imag / STEP for each in step], axis=1)

    def surface(self, r: FloatArray) -> FloatArray:
        """Plane coordinates (2, n) of the surface points at the radii r [mm]."""
        return np.array([r, np.zeros_like(r)])


@dataclass(frozen=True)
class Oblate(Flat):
    """Oblate-spheroidal coordinates of a half-space under a disc of radius a.

    ``r + i z = a cosh(mu + i phi)`` with the plane's coordinates (phi, mu): the disc is mu = 0, the free
    surface phi = 0, the axis phi = pi/2. The inverse is a square root at the edge of the disc, so that
    the square roots in the stresses become polynomials.
    """

    radius: float

    def point(self, plane: FloatArray) -> FloatArray:
        """Radius and depth [mm] at (phi, mu)."""
        phi, mu = plane
        return self.radius * np.array([np.cosh(mu) * np.cos(phi), np.sinh(mu) * np.sin(phi)])

    def surface(self, r: FloatArray) -> FloatArray:
        """Plane coordinates of surface points, on the disc or outside it."""
        ratio = r / self.radius
        return np.array([np.arccos(np.minimum(ratio, 1.0)), np.arccosh(np.maximum(ratio, 1.0))])


@dataclass(frozen=True)
class Cap(Flat):
    """A spherical cap on a block; columns of elements leave the foot of the cap along its bisector.

    On the cap, the first coordinate of the plane is the angle from the summit, scaled to the true radius at
    the foot; outside, it is the radius. The second is the depth below the surface; lines of
    constant depth are flat at the base of the block. z is zero at the top of the block, -height at the
    summit.
    """

    radius: float  # of the sphere [mm]
    height: float  # of the cap [mm], up to the radius
    outer: float  # radius of the block [mm]
    thickness: float  # of the block [mm]

    @property
    def foot(self) -> float:
        """Radius of the cap's base [mm]."""
        return float(foot_radius(self.height, self.radius))

    @property
    def angle(self) -> float:
        """Slope of the sphere at the foot [rad]."""
        return math.acos(1.0 - self.height / self.radius)

    def point(self, plane: FloatArray) -> FloatArray:
        """Radius and depth [mm]."""
        s, depth = plane
        inside = np.real(s) < self.foot
        theta = np.where(inside, s * self.angle / self.foot, self.angle)
        # Radius of the column below the foot over that of the foot. Far below, half of the radius remains, so
        # that the columns under the cap do not become too narrow.
        keep = 0.5 + 0.5 * np.exp(-2.0 * math.tan(0.5 * self.angle) / self.foot * depth)
        stretch = (self.outer - self.foot * keep) / (self.outer - self.foot)
        across = np.where(inside, self.radius * np.sin(theta) * keep, self.outer - (self.outer - s) * stretch)
        # height of the surface, and of a line of constant depth over it: 1 at the top, 0 at the base
        rise = np.where(inside, self.radius * np.cos(theta) - (self.radius - self.height), 0.0)
        fade = 1.0 / (1.0 + depth / self.foot) - depth / self.thickness / (1.0 + self.thickness / self.foot)
        return np.array([across, depth - rise * fade])

    def surface(self, r: FloatArray) -> FloatArray:
        """Plane coordinates of surface points."""
        inside = np.arcsin(np.minimum(r / self.radius, 1.0)) * self.foot / self.angle
        return np.array([np.where(r < self.foot, inside, r), np.zeros_like(r)])


def checked_cap(a: float, radius: Any, height: Any, thickness: Any, side_name: str, side: Any) -> Cap:
    """Return the cap on a block, after checking that the contact fits on the cap and the cap on the block."""
    R = check.number("radius", radius, above=0.0)
    h = check.number("height", height, above=0.0, at_most=R)
    t = check.number("thickness", thickness, above=0.0)
    cap = Cap(R, h, check.number(side_name, side, above=0.0), t)
    refuse_if(t < h, f"thickness = {t:g} must be at least the cap's height = {h:g}")
    refuse_if(
        cap.foot >= cap.outer,
        f"the cap's foot of radius {cap.foot:g} must lie within {side_name} = {cap.outer:g}",
    )
    refuse_if(a >= cap.foot, f"contact_radius = {a:g} must lie within the cap's edge at {cap.foot:g}")
    return cap
