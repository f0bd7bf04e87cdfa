"""The caps of a surface and properties of their contact law; lengths are in cells."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from metafem._validate import FloatArray
from metafem.contact import Elastic, Hertz
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import area_change, sizes_of
from metafem.surface import Surface

# Largest indentation, divided by R, for laws without a limit (a sphere then has the contact radius R within
# 1e-8); and number of bisections of the contact radius, which reach rounding.
DEEPEST = 10.0
BISECTIONS = 52

# Contact radii below this multiple of the largest one are zero within rounding.
ROUNDING = 1e-12

# Smallest distance from the summit, divided by the largest contact radius, at which a contact on a slope may
# begin.
FLATTEST = 1e-3

# Upper bound for the load of an isolated contact divided by the load of a contact of the same radius in the
# field of its neighbours, which flatten the summit. Below this bound the equation for the radius is monotonic
# for all power caps.
MOST_LOAD = 2.0

# Number of quadrature nodes for the shape of a pressure; number of distances at which the shape is computed;
# and the smallest and largest of these distances, divided by the contact radius. Between two distances the
# shape is interpolated by a power of the distance.
NODES, DISTANCES = 16, 100
NEAREST, FARTHEST = 0.1, 2.0


@dataclass(frozen=True, eq=False)
class Summits:
    """Positions (n, 2), summit depths (n,) and radii (n,) of asperities, in cells, and their cap."""

    position: FloatArray
    depth: FloatArray
    radius: FloatArray
    cap: Hertz | Elastic = PARABOLOID
    cell: float = 1.0  # [mm]
    of_law: Any = 0.0  # what the law takes as the radius of each asperity, (n,) [mm]

    @classmethod
    def of(cls, surface: Surface, cap: Hertz | Elastic, cell: float) -> Summits:
        """Return the summits of a surface, with lengths divided by the cell."""
        low, high = surface.position.min(axis=0), surface.position.max(axis=0)
        # relative to the corner, so that no digits are lost if the surface is far from the origin
        position = ((surface.position - low) - 0.5 * (high - low)) / cell
        of_law = cap.summits(surface)
        return cls(position, surface.gap / cell, sizes_of(of_law) / cell, cap, cell, of_law)

    @property
    def paraboloids(self) -> bool:
        """Whether the caps are paraboloids, for which closed forms exist."""
        return self.cap == PARABOLOID

    def depth_beside(self, i: int, square: FloatArray) -> FloatArray:
        """Return the depth of the cap of asperity i below its summit at squared distances `square`."""
        if self.paraboloids:  # closed form, without a square root
            return np.asarray(square / (2.0 * self.radius[i]))
        distance = self.cell * np.sqrt(square)
        return np.asarray(self.cap.depth_at(distance, self.of_law[i]) / self.cell)

    def widest(self) -> FloatArray:
        """Return the largest contact radii that the law describes, (n,)."""
        most = self.cap.largest_indentation(self.of_law)
        deepest = np.where(np.isfinite(most), most, DEEPEST * self.cell * self.radius)
        return np.asarray(self.cap.contact_radius(deepest, self.of_law) / self.cell)

    def lift(self, slope: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the increase of the indentation by slopes g of the field, and its distance rho, (n,).

        The increase is the maximum of ``g rho - f(rho)``. The contact on a flat summit begins far from the
        axis. The contact of a paraboloid contains the axis, and its increase R g^2/2 is smaller than the gaps
        that have cells, so that 0 is returned.
        """
        if self.paraboloids:
            return np.zeros(slope.shape), np.zeros(slope.shape)
        distance = self.cell * self.widest()[:, None] * np.geomspace(FLATTEST, 1.0, DISTANCES)
        gain = slope[:, None] * distance - self.cap.depth_at(distance, self.of_law[:, None])
        best = (np.arange(len(slope)), gain.argmax(axis=1))
        beside = gain[best] > 0.0
        return beside * gain[best] / self.cell, beside * distance[best] / self.cell

    def bluntness(self, contact_radius: FloatArray) -> FloatArray:
        """Return the radius, divided by R, of paraboloids with equal contact radius and indentation, (n,)."""
        if self.paraboloids:
            return np.ones(contact_radius.shape)
        inside = np.minimum(contact_radius, self.widest())
        closed = inside > 0.0
        depth = self.cap.indentation(self.cell * inside, self.of_law) / self.cell
        return np.where(closed, inside**2 / np.where(closed, self.radius * depth, 1.0), 1.0)

    def areas(self, spread: FloatArray, load: FloatArray, shift: FloatArray) -> FloatArray:
        """Return the areas of contacts with loads P and second moments M = 2 s P of the pressure, (n,).

        M is about the centroid. shift: distances from the summits to the centroids of the pressure.

        The field of the neighbours adds an unknown curvature, whose contribution to M is 2/5 a^2 times its
        contribution to P, as for a paraboloid. Therefore ``M - 2/5 P a^2 = M0(a) - 2/5 P0(a) a^2`` with M0
        and P0 of an isolated contact; bisection gives a. The slope g of the field moves the centroid by
        ``4/3 a^3 g/P``. It changes the area by the fraction `area_change`, and the area computed from M by
        the fraction ``(10 - 20/3 a^2 D'/P) (g/D')^2``. Both fractions are zero for paraboloids.
        """
        if self.paraboloids:
            return 5.0 * math.pi * spread
        radius, low, widest = self.of_law, np.zeros(spread.shape), self.cell * self.widest()
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
        """Return the smooth factor p/sqrt(a^2 - rho^2) of the pressure on a patch, up to a constant.

        ``p = 1/pi int_rho^a D'(s)/sqrt(s^2 - rho^2) ds`` is ``sqrt(a^2 - rho^2)/pi`` times the mean of D'/s
        over 0 < u < 1 with ``s^2 = rho^2 + (a^2 - rho^2) u^2``. The factor is smooth across the edge of the
        contact, and is 1 for paraboloids.
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
            mean = (1.0 / self.cap.area_slope(s, self.of_law[i])) @ weight
            distance = np.log(np.maximum(np.hypot(x, y), NEAREST * a))
            shape[here] = np.exp(np.interp(distance, np.log(a * part), np.log(mean / mean.max())))
        return shape
