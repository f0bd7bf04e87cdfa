"""The contact law of true caps by finite elements, tabulated for the caps of a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact import Hertz
from metafem.contact.cap_geometry import foot_radius
from metafem.errors import InvalidInput, NotConverged
from metafem.progress import each
from metafem.surface import Surface

# Chebyshev nodes in the cap's height and in the ratio of contact radius to foot radius. The deviations of
# load and indentation from Hertz's law are smooth in both and vanish for small contacts. With 3 x 3 nodes the
# error is 6e-5 on the source paper's red bilinear surface; `CapContact.error` estimates it.
HEIGHT_NODES, RATIO_NODES = 3, 3

# Largest number of radii: each needs a table, which takes half a minute.
MOST_RADII = 4

# Largest number of Newton steps for the contact radius; starting from Hertz's, 5 steps suffice to rounding.
NEWTON_STEPS = 30


@dataclass(frozen=True, eq=False)
class CapContact:
    """Load and indentation of a cap's contact, relative to Hertz's law at the same contact radius.

    ``P = P_Hertz (1 + s f(h, s))`` and ``d = d_Hertz (1 + s g(h, s))`` with s = a/foot, the foot
    radius ``sqrt(h (2 R - h))`` of the cap, and polynomials f, g through finite-element solutions.
    """

    radius: float  # R [mm]
    height: tuple[float, float]  # range of the table in h [mm]
    ratio: tuple[float, float]  # range of the table in s [-]
    load_excess: FloatArray  # coefficients of f in scaled h and s, in ascending order
    indentation_excess: FloatArray  # the same for g
    error: float  # largest relative error of load or indentation at a test solution that is not in the table

    def solve(self, height: FloatArray, indentation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return contact radii [mm] and rescaled loads [mm^2] at indentations d [mm], (n,); 0 if open.

        Raises NotConverged if the table cannot be extrapolated to an indentation.
        """
        open_ = indentation <= 0.0
        d, h = np.where(open_, 1.0, indentation), height
        foot = foot_radius(h, self.radius)
        a = Hertz().contact_radius(d, self.radius)
        for _ in range(NEWTON_STEPS):
            step = 1e-6 * a
            value, ahead = (self._indentation(h, x, foot) for x in (a, a + step))
            change = (d - value) * step / (ahead - value)
            a = np.where(a + change > 0.0, a + change, 0.5 * a)
            if (np.abs(change[~open_]) <= 1e-13 * a[~open_]).all():
                break
        else:
            raise NotConverged("the table of caps cannot be extrapolated to this indentation", a)
        load = Hertz().load(a, self.radius) * (1.0 + a / foot * self._excess(self.load_excess, h, a / foot))
        return np.where(open_, 0.0, a), np.where(open_, 0.0, load)

    def _indentation(self, h: FloatArray, a: FloatArray, foot: FloatArray) -> FloatArray:
        ratio = a / foot
        return a**2 / self.radius * (1.0 + ratio * self._excess(self.indentation_excess, h, ratio))

    def _excess(self, table: FloatArray, h: FloatArray, ratio: FloatArray) -> FloatArray:
        return np.asarray(
            np.polynomial.polynomial.polyval2d(_scaled(h, self.height), _scaled(ratio, self.ratio), table)
        )


@dataclass(frozen=True, eq=False)
class Caps:
    """The caps of a surface: a table for each radius of the summits in contact."""

    surface: Surface
    tables: tuple[CapContact, ...]  # one for each radius
    table: IntArray  # (n,), index of the table of each asperity; -1 if none of its radius is in contact

    @property
    def error(self) -> float:
        """Largest relative error of the tables."""
        return max(table.error for table in self.tables)

    def solve(self, indentation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return contact radii [mm] and rescaled loads [mm^2] at indentations d [mm], (n,); 0 if open.

        Asperities without a table follow Hertz's law.
        """
        depth = np.maximum(indentation, 0.0)
        a = Hertz().contact_radius(depth, self.surface.radius)
        load = Hertz().load(a, self.surface.radius)
        for k, table in enumerate(self.tables):
            own = self.table == k
            a[own], load[own] = table.solve(self.surface.height[own], indentation[own])
        return a, load


def caps_of(surface: Surface, indentation: FloatArray) -> Caps:
    """Compute the caps of each radius by finite elements, up to given indentations (n,) [mm].

    Raise InvalidInput if summits of more than four radii are in contact, and for the errors of `cap_contact`.
    """
    radii = np.unique(surface.radius[indentation > 0.0])
    if len(radii) > MOST_RADII:
        raise InvalidInput(
            f"the summits in contact have {len(radii)} different radii; "
            f"finite elements of caps are limited to {MOST_RADII} radii"
        )
    tables, table = [], np.full(surface.count, -1)
    for k, radius in enumerate(radii):
        own = surface.radius == radius
        tables.append(cap_contact(surface, np.where(own, indentation, 0.0)))
        table[own] = k
    return Caps(surface, tuple(tables), table)


def cap_contact(surface: Surface, indentation: FloatArray) -> CapContact:
    """Compute the caps of a surface by finite elements, up to given indentations (n,) [mm].

    Each is a true spherical cap on a bonded cylinder with a free side and the block's thickness and base
    area, at small strain, with the Poisson's ratio of the material. Raise InvalidInput if the surface has no
    block, or if the summits in contact have several radii or not 0 < h <= R.
    """
    touching = indentation > 0.0
    block, radius = surface.block, float(surface.radius[touching][0])
    if block is None:
        raise InvalidInput("the surface has no block")
    if np.ptp(surface.radius[touching]) > 0.0:
        raise InvalidInput("the summits differ in their radii")
    heights = surface.height[touching]
    if heights.min() <= 0.0 or heights.max() > radius:
        raise InvalidInput("the height of a summit in contact must be above 0 and at most its radius")
    foot = foot_radius(heights, radius)
    ratio = Hertz().contact_radius(indentation[touching], radius) / foot
    low, high = float(heights.min()), float(heights.max())
    # small contacts obey Hertz's law; starting at a tenth of the range keeps the smallest contact meshable
    ranges = (low, high), (0.1 * float(ratio.max()), min(float(ratio.max()), 0.9))
    nu, side = surface.material.poisson_ratio, math.sqrt(block.width * block.length / math.pi)

    def excess(h: float, s: float) -> tuple[float, float]:
        from metafem.fe import press

        foot = float(foot_radius(h, radius))
        a = s * foot
        contact = press(a, radius, nu, height=h, thickness=block.thickness, block_radius=side)
        load = contact.rescaled_load / float(Hertz().load(a, radius))
        return (load - 1.0) / s, (contact.indentation * radius / a**2 - 1.0) / s

    h_nodes = _nodes(*ranges[0], HEIGHT_NODES if high > low else 1)
    s_nodes = _nodes(*ranges[1], RATIO_NODES)
    pairs = [(h, s) for h in h_nodes for s in s_nodes]
    pressed = [excess(h, s) for h, s in each("finite elements of a cap", pairs)]
    found = np.array(pressed).reshape(len(h_nodes), len(s_nodes), 2)
    tables = []
    for k in (0, 1):
        by_height = np.vander(_scaled(h_nodes, ranges[0]), increasing=True)
        by_ratio = np.vander(_scaled(s_nodes, ranges[1]), increasing=True)
        tables.append(np.linalg.solve(by_height, found[:, :, k]) @ np.linalg.inv(by_ratio).T)
    loads, indentations = tables
    bare = CapContact(radius, ranges[0], ranges[1], loads, indentations, math.nan)
    # between the nodes, where the errors of both polynomials are nearly largest
    place = np.array([0.75 * low + 0.25 * high, 0.6 * ranges[1][1]])
    error = max(
        abs(s_excess - float(bare._excess(table, place[0], place[1]))) * place[1]
        for s_excess, table in zip(excess(*place), tables, strict=True)
    )
    return replace(bare, error=error)


def _nodes(low: float, high: float, count: int) -> FloatArray:
    """Return the Chebyshev nodes of an interval."""
    angle = math.pi * (np.arange(count) + 0.5) / count
    return np.asarray(0.5 * (low + high) - 0.5 * (high - low) * np.cos(angle))


def _scaled(value: FloatArray, interval: tuple[float, float]) -> FloatArray:
    low, high = interval
    return np.asarray((2.0 * value - low - high) / (high - low) if high > low else np.zeros_like(value))
