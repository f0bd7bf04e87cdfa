"""Contact laws of true caps, computed by finite elements and tabulated for the caps of a surface."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.chebyshev import chebpts1
from numpy.polynomial.polynomial import polyval2d
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
HEIGHT_NODES, RATIO_NODES = 3, 3

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
            a[closed], load[closed] = (
                found.x,
                self._relative(found.x, h)[0] * HERTZ.load(found.x, self.radius),
            )
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
        x, y = _scaled(h, self.height), _scaled(ratio, self.ratio)
        return np.asarray(polyval2d(x, y, self.excess))


def solve_caps(
    surface: Surface, tables: Mapping[float, CapContact], indentation: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return contact radii [mm] and rescaled loads [mm^2] of all caps at indentations (n, k) [mm]; 0 if open.

    Asperities whose radius has no table follow Hertz's law.
    """
    depth, radius = np.maximum(indentation, 0.0), surface.radius[:, None]
    a = HERTZ.contact_radius(depth, radius)
    load = HERTZ.load(a, radius)
    for size, table in tables.items():
        own = surface.radius == size
        a[own], load[own] = table.solve(surface.height[own, None], indentation[own])
    return a, load


def caps_of(surface: Surface, indentation: FloatArray) -> dict[float, CapContact]:
    """Return the contact law of each radius [mm] by finite elements, up to the indentations (n,) [mm].

    The law is that of a true spherical cap on a bonded cylinder, at small strain. The cylinder has a free
    side, the thickness and base area of the block, and the Poisson's ratio of the material. Raise
    InvalidInput if the surface has no block, if the summits in contact have more than four radii, or if one
    of these summits does not satisfy 0 < h <= R.
    """
    touching = indentation > 0.0
    refuse_if(
        touching.any() and surface.cap.at(touching) != SPHERE,
        f"must be {SPHERE!r}, the cap of the finite elements",
        key="cap",
        value=repr(surface.cap),
    )
    radii, height = np.unique(surface.radius[touching]).tolist(), surface.height[touching]
    refuse_if(
        len(radii) > MOST_RADII,
        f"the summits in contact have {len(radii)} different radii; "
        f"finite elements of caps are limited to {MOST_RADII} radii",
    )
    refuse_if(surface.block is None, "the surface has no block")
    words = "the height of a summit in contact must be above 0 and at most its radius"
    refuse_if(((height <= 0.0) | (height > surface.radius[touching])).any(), words)
    return {
        radius: cap_contact(surface, radius, touching & (surface.radius == radius), indentation)
        for radius in radii
    }


def cap_contact(
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
    # the table starts at a tenth of the range: smaller contacts obey Hertz's law and are hard to mesh
    ranges = (low, high), (0.1 * ratio, min(ratio, 0.9))

    def excess(h: float, s: float) -> FloatArray:
        """Return f and g at height h [mm] and ratio s, (2,)."""
        a = s * float(foot_radius(h, radius))
        contact = press(a, radius, nu, height=h, thickness=block.thickness, block_radius=side)
        load = contact.rescaled_load / float(HERTZ.load(a, radius))
        return np.array([load - 1.0, contact.indentation * radius / a**2 - 1.0]) / s

    counts = HEIGHT_NODES if high > low else 1, RATIO_NODES
    scaled = [chebpts1(count) for count in counts]
    nodes = [
        0.5 * (first + last) + 0.5 * (last - first) * x
        for (first, last), x in zip(ranges, scaled, strict=True)
    ]
    pairs = [(h, s) for h in nodes[0] for s in nodes[1]]
    pressed = [excess(h, s) for h, s in each("finite elements of a cap", pairs)]
    by_height, by_ratio = (np.linalg.inv(np.vander(x, increasing=True)) for x in scaled)
    table = np.einsum("ih,hsk,js->ijk", by_height, np.reshape(pressed, (*counts, 2)), by_ratio)
    bare = CapContact(radius, *ranges, table)
    # a test point between the nodes, where the errors of both polynomials are close to their maximum
    h, s = 0.75 * low + 0.25 * high, 0.6 * ranges[1][1]
    error = np.abs(excess(h, s) - bare.excess_at(np.array(h), np.array(s))).max() * s
    return replace(bare, error=float(error))


def _scaled(value: FloatArray, interval: tuple[float, float]) -> FloatArray:
    low, high = interval
    return np.asarray((2.0 * value - low - high) / (high - low) if high > low else np.zeros_like(value))
