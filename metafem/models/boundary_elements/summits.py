"""The caps of a surface in units of the cell, and the pressure of their contact law for resolved contacts."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.contact import Hertz
from metafem.contact.caps import ElasticCap
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import area_change
from metafem.surface import Surface

# Largest indentation over R for laws without a largest one of their own (there a sphere has the contact
# radius R within 1e-8); and halvings of the contact radius, down to rounding.
DEEPEST = 10.0
BISECTIONS = 52

# A contact radius below this multiple of the largest one is zero within rounding.
ROUNDING = 1e-12

# Smallest distance, over the largest contact radius, at which a contact on a slope may begin.
FLATTEST = 1e-3

# Load of the undisturbed contact with the radius of a contact, over the load of that contact: the field of
# neighbours flattens a summit by less. Below this the equation for the radius is monotone for all power caps.
MOST_LOAD = 2.0

# Nodes of the quadrature for the shape of a pressure; number of distances at which it is computed; and the
# smallest and largest of these over the contact radius. Between them it is a power of the distance.
NODES, DISTANCES = 16, 100
NEAREST, FARTHEST = 0.1, 2.0


@dataclass(frozen=True, eq=False)
class Summits:
    """Asperities in units of the cell: positions (n, 2), summit depths (n,), radii (n,), and their cap."""

    position: FloatArray
    depth: FloatArray
    radius: FloatArray
    cap: Hertz | ElasticCap = PARABOLOID
    cell: float = 1.0  # [mm]

    @classmethod
    def of(cls, surface: Surface, cap: Hertz | ElasticCap, cell: float) -> Summits:
        """Measure a surface in cells."""
        low, high = surface.position.min(axis=0), surface.position.max(axis=0)
        # halved before the sum, so that a corner far from the origin costs no digits
        position = ((surface.position - low) - 0.5 * (high - low)) / cell
        return cls(position, surface.gap / cell, surface.radius / cell, cap, cell)

    @property
    def paraboloids(self) -> bool:
        """Whether the caps are paraboloids, for which closed forms hold."""
        return self.cap == PARABOLOID

    def depth_beside(self, i: int, square: FloatArray) -> FloatArray:
        """Depth of the cap of asperity i below its summit, over the square of the distance."""
        if self.paraboloids:  # without the square of a root
            return np.asarray(square / (2.0 * self.radius[i]))
        distance = self.cell * np.sqrt(square)
        return np.asarray(self.cap.depth_at(distance, self.cell * self.radius[i]) / self.cell)

    def widest(self) -> FloatArray:
        """Largest contact radii that the law describes, (n,)."""
        radius = self.cell * self.radius
        most = self.cap.largest_indentation(radius)
        deepest = np.where(np.isfinite(most), most, DEEPEST * radius)
        return np.asarray(self.cap.contact_radius(deepest, radius) / self.cell)

    def lift(self, slope: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Increase of the indentation by a slope of the field, and the distance of the contact then, (n,).

        The maximum of ``g rho - f(rho)``. A contact on a flat summit begins far from its axis. That of a
        paraboloid contains the axis, and its increase R g^2/2 is less than the gaps covered by cells: 0.
        """
        if self.paraboloids:
            return np.zeros(slope.shape), np.zeros(slope.shape)
        distance = self.cell * self.widest()[:, None] * np.geomspace(FLATTEST, 1.0, DISTANCES)
        gain = slope[:, None] * distance - self.cap.depth_at(distance, self.cell * self.radius[:, None])
        best = (np.arange(len(slope)), gain.argmax(axis=1))
        beside = gain[best] > 0.0
        return beside * gain[best] / self.cell, beside * distance[best] / self.cell

    def bluntness(self, contact_radius: FloatArray) -> FloatArray:
        """Radius, divided by R, of the paraboloid with the same contact radius and indentation, (n,)."""
        if self.paraboloids:
            return np.ones(contact_radius.shape)
        inside = np.minimum(contact_radius, self.widest())
        closed = inside > 0.0
        depth = self.cap.indentation(self.cell * inside, self.cell * self.radius) / self.cell
        return np.where(closed, inside**2 / np.where(closed, self.radius * depth, 1.0), 1.0)

    def areas(self, spread: FloatArray, load: FloatArray, shift: FloatArray) -> FloatArray:
        """Areas of contacts with the second moment M = 2 s P of the pressure and the load P, (n,).

        shift: distances from the summits to the centroids of the pressure. M is about the centroid.

        The field of the neighbours adds an unknown curvature. Its contribution to M is 2/5 a^2 times that to
        P, as for a paraboloid. So ``M - 2/5 P a^2 = M0(a) - 2/5 P0(a) a^2``, with the undisturbed contact on
        the right; bisection gives a. The slope g of the field moves the centroid by ``4/3 a^3 g/P`` and
        changes the area by the fraction `area_change`, but the area from M by the fraction
        ``(10 - 20/3 a^2 D'/P) (g/D')^2``: both are zero for paraboloids.
        """
        if self.paraboloids:
            return 5.0 * math.pi * spread
        radius, low, widest = self.cell * self.radius, np.zeros(spread.shape), self.cell * self.widest()
        high = widest
        carried = self.cell**2 * load
        moment = 2.0 * self.cell**2 * spread * carried
        for _ in range(BISECTIONS):
            a = 0.5 * (low + high)
            alone = self.cap.load(a, radius)
            own = self.cap.second_moment(a, radius) - 0.4 * a**2 * alone
            wide = (own > moment - 0.4 * a**2 * carried) | (alone > MOST_LOAD * carried)
            low, high = np.where(wide, low, a), np.where(wide, a, high)
        closed = low > ROUNDING * widest  # pressure on one cell has no moment
        a, carried = np.where(closed, low, 0.5 * widest), np.where(closed, carried, 1.0)
        slope, own = carried * self.cell * shift / (4.0 / 3.0 * a**3), self.cap.profile_slope(a, radius)
        seen = (10.0 - 20.0 / 3.0 * a**2 * own / self.cap.load(a, radius)) * (slope / own) ** 2
        change = np.maximum(1.0 + area_change(self.cap, a, radius, slope) - seen, 0.0)
        return np.where(closed, math.pi * (a / self.cell) ** 2 * change, 0.0)

    def pressure_shape(
        self, corner: NDArray[np.int64], owner: NDArray[np.int64], contact_radius: FloatArray
    ) -> FloatArray | float:
        """Pressure over sqrt(a^2 - rho^2) on the cells of a patch, up to a factor; smooth across the edge.

        ``p = 1/pi int_rho^a D'(s)/sqrt(s^2 - rho^2) ds`` is ``sqrt(a^2 - rho^2)/pi`` times the mean of D'/s
        over u with ``s^2 = rho^2 + (a^2 - rho^2) u^2``, 0 < u < 1. It is 1 for paraboloids.
        """
        if self.paraboloids:
            return 1.0
        shape = np.ones(owner.shape)
        node, weight = np.polynomial.legendre.leggauss(NODES)
        part = np.geomspace(NEAREST, FARTHEST, DISTANCES)
        square = part[:, None] ** 2 + (1.0 - part[:, None] ** 2) * (0.5 * (node + 1.0)) ** 2
        widest = self.widest()
        for i in np.unique(owner):
            a = min(contact_radius[i], widest[i])
            if a == 0.0:
                continue
            here = owner == i
            x, y = (np.argwhere(here) + corner - self.position[i]).T
            s = self.cell * np.minimum(a * np.sqrt(square), widest[i])
            mean = (1.0 / self.cap.area_slope(s, self.cell * self.radius[i])) @ weight
            distance = np.log(np.maximum(np.hypot(x, y), NEAREST * a))
            shape[here] = np.exp(np.interp(distance, np.log(a * part), np.log(mean / mean.max())))
        return shape
