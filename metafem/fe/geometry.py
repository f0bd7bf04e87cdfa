"""Meshes of reference planes, which are rectangles, and their maps to the meridian half-plane (r, z).

z points down. The named boundaries of a mesh are `contact`, `free`, `axis`, `base` and, if the body has a
side, `wall`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from skfem import MeshQuad

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.caps.shapes import foot_radius
from metafem.errors import refuse_if

# Width of the steeply graded zone at an edge, over the radius of the edge.
EDGE_REACH = 0.1


@dataclass(frozen=True)
class Flat:
    """Body with a flat top, for which the map is the identity; all maps are analytic, not interpolated."""

    def point(self, plane: FloatArray) -> FloatArray:
        """Return radius and depth [mm] of points (2, ...) of the reference plane."""
        return plane

    def jacobian(self, plane: FloatArray) -> FloatArray:
        """Return the derivatives of (r, z) by the plane's coordinates, (2, 2, ...), exact to rounding."""
        h = 1e-30  # f(x + i h) = f(x) + i h f'(x) has no cancellation
        step = h * np.eye(2).reshape((2, 2) + (1,) * (plane.ndim - 1))
        return np.stack([self.point(plane + 1j * each).imag / h for each in step], axis=1)

    def surface(self, r: FloatArray) -> FloatArray:
        """Return the plane coordinates (2, n) of the surface points at the radii r [mm]."""
        return np.array([r, np.zeros_like(r)])


@dataclass(frozen=True)
class Oblate(Flat):
    """Oblate-spheroidal coordinates of a half-space under a disc of radius a.

    ``r + i z = a cosh(mu + i phi)`` with the plane's coordinates (phi, mu). The disc is mu = 0, the free
    surface phi = 0, and the axis phi = pi/2. Near the edge of the disc, mu and phi vary with the square root
    of the distance, so that square roots in the stresses become polynomials.
    """

    radius: float

    def point(self, plane: FloatArray) -> FloatArray:
        """Return radius and depth [mm] at (phi, mu)."""
        phi, mu = plane
        return self.radius * np.array([np.cosh(mu) * np.cos(phi), np.sinh(mu) * np.sin(phi)])

    def surface(self, r: FloatArray) -> FloatArray:
        """Return the plane coordinates of surface points, on the disc or outside it."""
        ratio = r / self.radius
        return np.array([np.arccos(np.minimum(ratio, 1.0)), np.arccosh(np.maximum(ratio, 1.0))])


@dataclass(frozen=True)
class Cap(Flat):
    """Spherical cap on a block; at the cap's foot, the columns of elements start along the bisector.

    On the cap, the first plane coordinate is the angle from the summit, scaled so that it equals the radius
    at the foot; outside the cap, it is the radius. The second plane coordinate is the depth below the
    surface. Lines of constant depth are flat at the base of the block. z is 0 at the top of the block and
    -height at the summit.
    """

    radius: float  # of the sphere [mm]
    height: float  # of the cap [mm], at most the radius
    outer: float  # radius of the block [mm]
    thickness: float  # of the block [mm]

    @property
    def foot(self) -> float:
        """Radius of the cap's foot [mm]."""
        return float(foot_radius(self.height, self.radius))

    @property
    def angle(self) -> float:
        """Slope angle of the sphere at the foot [rad]."""
        return math.acos(1.0 - self.height / self.radius)

    def point(self, plane: FloatArray) -> FloatArray:
        """Return radius and depth [mm] of points (2, ...) of the reference plane."""
        s, depth = plane
        inside = np.real(s) < self.foot
        theta = np.where(inside, s * self.angle / self.foot, self.angle)
        # Radius of the column below the foot, over the foot radius. It decreases with depth, but not below
        # one half, so that the columns under the cap do not become too narrow.
        keep = 0.5 + 0.5 * np.exp(-2.0 * math.tan(0.5 * self.angle) / self.foot * depth)
        stretch = (self.outer - self.foot * keep) / (self.outer - self.foot)
        across = np.where(inside, self.radius * np.sin(theta) * keep, self.outer - (self.outer - s) * stretch)
        # height of the surface above the top of the block, and the fraction of this height by which a point
        # at `depth` is raised: 1 at the surface, 0 at the base
        rise = np.where(inside, self.radius * np.cos(theta) - (self.radius - self.height), 0.0)
        fade = 1.0 / (1.0 + depth / self.foot) - depth / self.thickness / (1.0 + self.thickness / self.foot)
        return np.array([across, depth - rise * fade])

    def surface(self, r: FloatArray) -> FloatArray:
        """Return the plane coordinates (2, n) of surface points at the radii r [mm]."""
        inside = np.arcsin(np.minimum(r / self.radius, 1.0)) * self.foot / self.angle
        return np.array([np.where(r < self.foot, inside, r), np.zeros_like(r)])


def checked_cap(a: float, radius: Any, height: Any, thickness: Any, side_name: str, side: Any) -> Cap:
    """Return a cap on a block; check that the contact fits on the cap and the cap on the block."""
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


def half_space_mesh(contact_edge: float) -> MeshQuad:
    """Return the mesh of the oblate-spheroidal plane (phi, mu) of a half-space.

    `contact_edge` is the size of the elements at the contact's edge, over the contact radius. Distances from
    the edge are phi^2/2. In phi the fields of a contact are low harmonics, so two more intervals are enough.
    """
    phi = np.array([0.0, math.sqrt(2.0 * contact_edge), 0.25 * math.pi, 0.5 * math.pi])
    # the fields decay as exp(-mu), which elements of length 2 to 4 resolve far away; the end at mu = 30 is
    # 5e12 contact radii away and is fixed
    mu = np.array([0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 15.0, 18.0, 22.0, 26.0, 30.0])
    mesh = MeshQuad.init_tensor(phi, mu)
    return mesh.with_boundaries(
        {
            "contact": lambda x: x[1] == 0.0,
            "free": lambda x: x[0] == 0.0,
            "axis": lambda x: x[0] == phi[-1],
            "base": lambda x: x[1] == mu[-1],
        }
    )


def graded_mesh(
    contact: float,
    outer: float,
    thickness: float,
    foot: float | None = None,
    *,
    contact_edge: float,
    foot_edge: float = 1e-3,
) -> MeshQuad:
    """Return a mesh of a body's plane (s, depth), graded towards the contact's edge and the cap's foot.

    `contact`, `outer` and `foot` are the plane coordinates of the contact's edge, the side and the foot [mm];
    the thickness is also in mm. `contact_edge` and `foot_edge` are the sizes of the smallest elements, over
    the radii of contact and foot.
    """
    fine, reach = contact_edge * contact, EDGE_REACH * contact
    across = [_graded(contact, 0.0, fine, reach)[::-1]]
    if foot is None:
        across.append(_graded(contact, outer, fine, reach, thickness))
    else:
        coarse, wide, middle = foot_edge * foot, EDGE_REACH * foot, 0.5 * (contact + foot)
        across += [
            _graded(contact, middle, fine, reach),
            _graded(foot, middle, coarse, wide)[::-1],
            _graded(foot, outer, coarse, wide, thickness),
        ]
    s = np.concatenate([across[0], *(part[1:] for part in across[1:])])
    mesh = MeshQuad.init_tensor(s, _graded(0.0, thickness, fine, reach))
    return named(mesh, contact, outer, thickness)


def named(mesh: MeshQuad, contact: float, outer: float, thickness: float) -> MeshQuad:
    """Return the mesh with named boundaries."""
    return mesh.with_boundaries(
        {
            "contact": lambda x: (x[1] == 0.0) & (x[0] < contact),
            "free": lambda x: (x[1] == 0.0) & (x[0] > contact),
            "axis": lambda x: x[0] == 0.0,
            "base": lambda x: x[1] == thickness,
            "wall": lambda x: x[0] == outer,
        }
    )


def _graded(
    fine_end: float, coarse_end: float, smallest: float, edge: float, largest: float = math.inf
) -> FloatArray:
    """Return points from the fine end to the coarse end; the first interval is at most `smallest`.

    The distances of the points from the fine end grow by a factor of 6 up to `edge`: steep grading is
    possible there, because a square root is smooth in the logarithm of the distance and the innermost
    elements contribute little. Beyond it they grow by a factor of 2, but by no more than `largest`; with
    degree 6 the fields then have an error of at most 1e-4.
    """
    distance = [smallest]
    while distance[-1] < abs(coarse_end - fine_end):
        x = distance[-1]
        distance.append(6.0 * x if x < edge else min(2.0 * x, x + largest))
    points = fine_end + (coarse_end - fine_end) * np.append(0.0, distance) / distance[-1]
    points[-1] = coarse_end
    return points
