"""Contact laws of true caps, computed by finite elements and tabulated for the caps of a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.chebyshev import chebpts1
from numpy.polynomial.polynomial import polyval2d, polyvander2d
from scipy.optimize import elementwise

from metafem._validate import FloatArray
from metafem.caps.shapes import SPHERE, foot_radius
from metafem.contact import Hertz
from metafem.errors import InvalidInput, NotConverged, refuse_if
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
        if closed.any():
            d, h = indentation[closed], height[closed]
            ends = np.zeros_like(d), WIDEST * HERTZ.contact_radius(d, self.radius)
            found = elementwise.find_root(self._beyond, ends, args=(d, h))
            if not found.success.all():
                raise NotConverged("the table of caps cannot be extrapolated to this indentation", found.x)
            a[closed] = found.x
            load[closed] = self.relative(found.x, h)[0] * HERTZ.load(found.x, self.radius)
        return a, load

    def _beyond(self, a: FloatArray, d: FloatArray, h: FloatArray) -> FloatArray:
        """Return the indentation at contact radii a minus the indentations d, (n,) [mm]."""
        return np.asarray(a**2 / self.radius * self.relative(a, h)[1] - d)

    def relative(self, a: FloatArray, h: FloatArray) -> FloatArray:
        """Return load and indentation over Hertz's values at the same contact radius, (2, n)."""
        ratio = a / foot_radius(h, self.radius)
        x, y = _scaled(h, *self.height), _scaled(ratio, *self.ratio)
        return np.asarray(1.0 + ratio * polyval2d(x, y, self.excess))


def law_of_caps(
    surface: Surface, caps: CapContact, rescaled_load: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return areas [mm^2] and separations [mm] (k,) of independent asperities with a tabulated law."""
    height = surface.height[:, None]

    def missing(separation: FloatArray, load: FloatArray) -> FloatArray:
        return np.asarray(caps.solve(height, height - separation)[1].sum(axis=0) - load)

    start, given = np.full(len(rescaled_load), float(height.max())), (rescaled_load,)
    ends = elementwise.bracket_root(missing, 0.98 * start, start, xmax=start, args=given).bracket
    separation = elementwise.find_root(missing, ends, args=given).x
    return np.pi * (caps.solve(height, height - separation)[0] ** 2).sum(axis=0), separation


def caps_of(surface: Surface, indentation: FloatArray) -> CapContact:
    """Return the contact law of the caps by finite elements, up to the indentations (n,) [mm].

    The law is that of a true spherical cap on a bonded cylinder, at small strain. The cylinder has a free
    side, the thickness and base area of the block, and the Poisson's ratio of the material. Raise
    InvalidInput if the surface has no block, if the summits in contact have different radii, or if one of
    them does not satisfy 0 < h <= R.
    """
    from metafem.fe import press

    touching = indentation > 0.0
    heights, radii, block = surface.height[touching], surface.radius[touching], surface.block
    words = f"must be {SPHERE!r}, the cap of the finite elements"
    refuse_if(surface.cap.at(touching) != SPHERE, words, key="cap", value=repr(surface.cap))
    words = "the summits in contact have different radii; finite elements of caps are limited to one radius"
    refuse_if(np.ptp(radii) > 0.0, words)
    words = "the height of a summit in contact must be above 0 and at most its radius"
    refuse_if(((heights <= 0.0) | (heights > radii)).any(), words)
    if block is None:
        raise InvalidInput("the surface has no block")
    radius, side = float(radii[0]), math.sqrt(block.width * block.length / math.pi)

    def pressed(h: float, s: float) -> FloatArray:
        """Return load and indentation over Hertz's values at height h [mm] and ratio s, (2,)."""
        a = s * float(foot_radius(h, radius))
        nu = surface.material.poisson_ratio
        found = press(a, radius, nu, height=h, thickness=block.thickness, block_radius=side)
        return np.array([found.rescaled_load / HERTZ.load(a, radius), found.indentation * radius / a**2])

    widest = HERTZ.contact_radius(indentation[touching], radius) / foot_radius(heights, radius)
    low, high, ratio = float(heights.min()), float(heights.max()), float(widest.max())
    ranges = (low, high), (SMALLEST * ratio, min(ratio, LARGEST))
    nodes = [chebpts1(NODES if end > start else 1) for start, end in ranges]
    x, y = (values.ravel() for values in np.meshgrid(*nodes, indexing="ij"))
    h, s = (start + (end - start) * (at + 1.0) / 2.0 for (start, end), at in zip(ranges, (x, y), strict=True))
    pairs = list(zip(h.tolist(), s.tolist(), strict=True))
    excess = [(pressed(*pair) - 1.0) / pair[1] for pair in each("finite elements of a cap", pairs)]
    counts = [len(at) for at in nodes]
    powers = polyvander2d(x, y, [count - 1 for count in counts])
    table = CapContact(radius, *ranges, np.linalg.solve(powers, excess).reshape(*counts, 2))
    # a test point between the nodes, where the errors of both polynomials are close to their maximum
    height, most = 0.75 * low + 0.25 * high, 0.6 * ranges[1][1]
    at = np.array([most * float(foot_radius(height, radius))])
    error = np.abs(pressed(height, most) - table.relative(at, np.array([height]))[:, 0]).max()
    return replace(table, error=float(error))


def _scaled(value: FloatArray, low: float, high: float) -> FloatArray:
    return np.asarray((2.0 * value - low - high) / (high - low) if high > low else np.zeros_like(value))
