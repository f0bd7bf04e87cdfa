"""The contact law of true caps by finite elements, tabulated for the caps of a surface."""

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
from metafem.contact import Hertz
from metafem.contact.cap_geometry import foot_radius
from metafem.errors import NotConverged, refuse_if
from metafem.progress import each
from metafem.surface import Surface

# Chebyshev nodes in the cap's height and in the ratio of contact radius to foot radius. The deviations of
# load and indentation from Hertz's law are smooth in both and vanish for small contacts. With 3 x 3 nodes the
# error is 6e-5 on the source paper's red bilinear surface; `CapContact.error` estimates it.
HEIGHT_NODES, RATIO_NODES = 3, 3

# Largest number of radii: each needs a table, which takes half a minute.
MOST_RADII = 4

# The contact radius is at most this multiple of Hertz's.
WIDEST = 2.0

HERTZ = Hertz()


@dataclass(frozen=True, eq=False)
class CapContact:
    """Load and indentation of a cap's contact, relative to Hertz's law at the same contact radius.

    ``P = P_Hertz (1 + s f(h, s))`` and ``d = d_Hertz (1 + s g(h, s))`` with s = a/foot, the foot
    radius ``sqrt(h (2 R - h))`` of the cap, and polynomials f, g through finite-element solutions.
    """

    radius: float  # R [mm]
    height: tuple[float, float]  # range of the table in h [mm]
    ratio: tuple[float, float]  # range of the table in s [-]
    excess: FloatArray  # (., ., 2), coefficients of f and g in scaled h and s, in ascending order
    error: float = math.nan  # largest relative error of both at a test solution that is not in the table

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
        """Return the indentation at a contact radius less a given one."""
        return np.asarray(a**2 / self.radius * self._relative(a, h)[1] - d)

    def _relative(self, a: FloatArray, h: FloatArray) -> FloatArray:
        """Return load and indentation over Hertz's, (2, n)."""
        ratio = a / foot_radius(h, self.radius)
        return np.asarray(1.0 + ratio * self.excess_at(h, ratio))

    def excess_at(self, h: FloatArray, ratio: FloatArray) -> FloatArray:
        """Return the polynomials f and g, (2, n)."""
        x, y = _scaled(h, self.height), _scaled(ratio, self.ratio)
        return np.asarray(polyval2d(x, y, self.excess))


def solve_caps(
    surface: Surface, tables: Mapping[float, CapContact], indentation: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return contact radii [mm] and rescaled loads [mm^2] of all caps at indentations (n, k) [mm]; 0 if open.

    Asperities of a radius without a table follow Hertz's law.
    """
    depth, radius = np.maximum(indentation, 0.0), surface.radius[:, None]
    a = HERTZ.contact_radius(depth, radius)
    load = HERTZ.load(a, radius)
    for size, table in tables.items():
        own = surface.radius == size
        a[own], load[own] = table.solve(surface.height[own, None], indentation[own])
    return a, load


def caps_of(surface: Surface, indentation: FloatArray) -> dict[float, CapContact]:
    """Compute the caps of each radius by finite elements, up to given indentations (n,) [mm].

    Each is a true spherical cap on a bonded cylinder with a free side and the block's thickness and base
    area, at small strain, with the Poisson's ratio of the material. Raise InvalidInput if the surface has no
    block, or if the summits in contact have more than four radii or not 0 < h <= R.
    """
    touching = indentation > 0.0
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
    """Compute the caps of one radius by finite elements, up to the indentations of some of them."""
    from metafem.fe import press

    block, nu = surface.block, surface.material.poisson_ratio
    assert block is not None
    side = math.sqrt(block.width * block.length / math.pi)
    heights = surface.height[which]
    ratio = float((HERTZ.contact_radius(indentation[which], radius) / foot_radius(heights, radius)).max())
    low, high = float(heights.min()), float(heights.max())
    # small contacts obey Hertz's law; starting at a tenth of the range keeps the smallest contact meshable
    ranges = (low, high), (0.1 * ratio, min(ratio, 0.9))

    def excess(h: float, s: float) -> FloatArray:
        """Return f and g."""
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
    # between the nodes, where the errors of both polynomials are nearly largest
    h, s = 0.75 * low + 0.25 * high, 0.6 * ranges[1][1]
    error = np.abs(excess(h, s) - bare.excess_at(np.array(h), np.array(s))).max() * s
    return replace(bare, error=float(error))


def _scaled(value: FloatArray, interval: tuple[float, float]) -> FloatArray:
    low, high = interval
    return np.asarray((2.0 * value - low - high) / (high - low) if high > low else np.zeros_like(value))
