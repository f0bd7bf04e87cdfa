"""Contact laws of true caps, computed by finite elements and tabulated for the caps of a surface."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.chebyshev import chebpts1
from numpy.polynomial.polynomial import polyval2d, polyvander2d
from numpy.typing import NDArray
from scipy.optimize import elementwise

from metafem._validate import FloatArray
from metafem.caps.shapes import SPHERE, foot_radius
from metafem.contact import Hertz
from metafem.errors import NotConverged, refuse_if
from metafem.progress import each
from metafem.surface import Surface

# Numbers of Chebyshev nodes in the cap's height and in the ratio of contact radius to foot radius. The
# deviations of load and indentation from Hertz's law are smooth functions of height and ratio, and vanish for
# small contacts. With 3 x 3 nodes the error is 6e-5 on the bilinear surface that the source paper draws in
# red; `CapContact.error` estimates the error.
NODES = 3

# Smallest ratio in the table over the largest: smaller contacts obey Hertz's law and are hard to mesh. Above
# LARGEST the contact reaches the foot of the cap.
SMALLEST, LARGEST = 0.1, 0.9

# Largest number of different radii. Each radius needs its own table, which takes half a minute to compute.
MOST_RADII = 4

# Upper bound of the contact radius in the root search, as a multiple of Hertz's contact radius.
WIDEST = 2.0

HERTZ = Hertz()


@dataclass(frozen=True, eq=False)
class CapContact:
    """Load and indentation of a cap's contact, relative to Hertz's law at the same contact radius.

    ``P = P_Hertz (1 + s f(h, s))`` and ``d = d_Hertz (1 + s g(h, s))``, where s is the ratio of the contact
    radius a to the foot radius ``sqrt(h (2 R - h))`` of the cap. The polynomials f and g interpolate
    finite-element solutions.
    """

    radius: float  # R [mm]
    height: tuple[float, float]  # range of the table in h [mm]
    ratio: tuple[float, float]  # range of the table in s [-]
    excess: FloatArray  # (., ., 2), coefficients of f and g in ascending powers of scaled h and s
    error: float = math.nan  # relative error of load and indentation at a solution that the table omits

    def solve(self, height: FloatArray, indentation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return contact radii [mm] and rescaled loads [mm^2] at indentations d [mm], (n, ...); 0 if open.

        Raises NotConverged if the table cannot be extrapolated to an indentation.
        """
        height, indentation = np.broadcast_arrays(height, indentation)
        a, load = np.zeros((2, *indentation.shape))
        closed = indentation > 0.0
        d, h = indentation[closed], height[closed]
        if d.size:
            most = WIDEST * HERTZ.contact_radius(d, self.radius)
            found = elementwise.find_root(self._beyond, (np.zeros_like(d), most), args=(d, h))
            if not found.success.all():
                raise NotConverged("the table of caps cannot be extrapolated to this indentation", found.x)
            a[closed] = found.x
            load[closed] = self._relative(found.x, h)[0] * HERTZ.load(found.x, self.radius)
        return a, load

    def _beyond(self, a: FloatArray, d: FloatArray, h: FloatArray) -> FloatArray:
        """Return the indentation at contact radii a minus the indentations d, (n,) [mm]."""
        return np.asarray(a**2 / self.radius * self._relative(a, h)[1] - d)

    def _relative(self, a: FloatArray, h: FloatArray) -> FloatArray:
        """Return load and indentation over Hertz's values at the same contact radius, (2, n)."""
        ratio = a / foot_radius(h, self.radius)
        return np.asarray(1.0 + ratio * self.excess_at(h, ratio))

    def excess_at(self, h: FloatArray, ratio: FloatArray) -> FloatArray:
        """Return the values of the polynomials f and g, (2, n)."""
        return np.asarray(polyval2d(_scaled(h, self.height), _scaled(ratio, self.ratio), self.excess))


def law_of_caps(
    surface: Surface, tables: Mapping[float, CapContact], rescaled_load: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return areas [mm^2] and separations [mm] (k,) of independent asperities with tabulated laws.

    Asperities whose radius has no table follow Hertz's law.
    """

    def solved(separation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return contact radii [mm] and rescaled loads [mm^2] of all caps, (n, k) each."""
        indentation = surface.height[:, None] - separation
        a = HERTZ.contact_radius(np.maximum(indentation, 0.0), surface.radius[:, None])
        load = HERTZ.load(a, surface.radius[:, None])
        for size, table in tables.items():
            own = surface.radius == size
            a[own], load[own] = table.solve(surface.height[own, None], indentation[own])
        return a, load

    def missing(separation: FloatArray, load: FloatArray) -> FloatArray:
        return np.asarray(solved(separation)[1].sum(axis=0) - load)

    start, given = np.full(len(rescaled_load), float(surface.height.max())), (rescaled_load,)
    ends = elementwise.bracket_root(missing, 0.98 * start, start, xmax=start, args=given).bracket
    separation = elementwise.find_root(missing, ends, args=given).x
    return np.pi * (solved(separation)[0] ** 2).sum(axis=0), separation


def caps_of(surface: Surface, indentation: FloatArray) -> dict[float, CapContact]:
    """Return the contact law of each radius [mm] by finite elements, up to the indentations (n,) [mm].

    The law is that of a true spherical cap on a bonded cylinder, at small strain. The cylinder has a free
    side, the thickness and base area of the block, and the Poisson's ratio of the material. Raise
    InvalidInput if the surface has no block, if the summits in contact have more than four radii, or if one
    of these summits does not satisfy 0 < h <= R.
    """
    touching = indentation > 0.0
    height, radius, cap = surface.height[touching], surface.radius[touching], surface.cap.at(touching)
    words = f"must be {SPHERE!r}, the cap of the finite elements"
    refuse_if(touching.any() and cap != SPHERE, words, key="cap", value=repr(surface.cap))
    radii = np.unique(radius).tolist()
    words = f"the summits in contact have {len(radii)} different radii; finite elements of caps are limited"
    refuse_if(len(radii) > MOST_RADII, f"{words} to {MOST_RADII} radii")
    refuse_if(surface.block is None, "the surface has no block")
    words = "the height of a summit in contact must be above 0 and at most its radius"
    refuse_if(((height <= 0.0) | (height > radius)).any(), words)
    return {
        each: _tabulated(surface, each, touching & (surface.radius == each), indentation) for each in radii
    }


def _tabulated(
    surface: Surface, radius: float, which: NDArray[np.bool_], indentation: FloatArray
) -> CapContact:
    """Return the contact law of the caps `which`, all of one radius, up to their indentations (n,) [mm]."""
    from metafem.fe import press

    block, nu = surface.block, surface.material.poisson_ratio
    assert block is not None
    side = math.sqrt(block.width * block.length / math.pi)
    heights = surface.height[which]
    ratio = float((HERTZ.contact_radius(indentation[which], radius) / foot_radius(heights, radius)).max())
    low, high = float(heights.min()), float(heights.max())
    ranges = (low, high), (SMALLEST * ratio, min(ratio, LARGEST))

    def excess(h: float, s: float) -> FloatArray:
        """Return f and g at height h [mm] and ratio s, (2,)."""
        a = s * float(foot_radius(h, radius))
        contact = press(a, radius, nu, height=h, thickness=block.thickness, block_radius=side)
        load = contact.rescaled_load / float(HERTZ.load(a, radius))
        return np.array([load - 1.0, contact.indentation * radius / a**2 - 1.0]) / s

    scaled = [chebpts1(NODES if end > start else 1) for start, end in ranges]
    x, y = (values.ravel() for values in np.meshgrid(*scaled, indexing="ij"))
    h, s = (start + (end - start) * (at + 1.0) / 2.0 for (start, end), at in zip(ranges, (x, y), strict=True))
    pairs = list(zip(h.tolist(), s.tolist(), strict=True))
    pressed = [excess(*pair) for pair in each("finite elements of a cap", pairs)]
    counts = [len(nodes) for nodes in scaled]
    powers = polyvander2d(x, y, [count - 1 for count in counts])
    table = np.asarray(np.linalg.solve(powers, pressed).reshape(*counts, 2), dtype=np.float64)
    bare = CapContact(radius, *ranges, table)
    # a test point between the nodes, where the errors of both polynomials are close to their maximum
    height, most = 0.75 * low + 0.25 * high, 0.6 * ranges[1][1]
    error = np.abs(excess(height, most) - bare.excess_at(np.array(height), np.array(most))).max() * most
    return replace(bare, error=float(error))


def _scaled(value: FloatArray, interval: tuple[float, float]) -> FloatArray:
    low, high = interval
    return np.asarray((2.0 * value - low - high) / (high - low) if high > low else np.zeros_like(value))
