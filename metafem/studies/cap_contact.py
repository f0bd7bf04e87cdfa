"""The law of one contact by finite elements of its true cap, tabulated for the caps of a surface."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact import Hertz
from metafem.errors import InvalidInput, NotConverged
from metafem.progress import each
from metafem.surface import Surface

# Chebyshev nodes in the cap's height and in the contact's share of its foot. What load and indentation
# have beyond Hertz's is smooth in both and vanishes with the contact: 3 x 3 nodes give load and
# indentation to 6e-5 on the source paper's red bilinear surface; `CapContact.error` tells.
HEIGHT_NODES, SHARE_NODES = 3, 3

# Radii of which each gets a table, of half a minute: the tools of a workshop.
MOST_RADII = 4

# Newton's steps for the contact radius at an indentation: from Hertz's, 5 reach rounding.
NEWTON_STEPS = 30


@dataclass(frozen=True, eq=False)
class CapContact:
    """Load and indentation of a cap's contact, over Hertz's at the same contact radius.

    ``P = P_Hertz (1 + s f(h, s))`` and ``d = d_Hertz (1 + s g(h, s))`` with the share s = a/foot of the
    cap's foot, ``sqrt(h (2 R - h))``, and f, g polynomials through finite-element solutions.

    Attributes
    ----------
    radius : float
        R [mm].
    height, share : (low, high)
        Range of the table, [mm] and [-].
    load_excess, indentation_excess : ndarray
        Coefficients of f and g in scaled height and share, ascending.
    error : float
        Largest relative change of load or indentation at a solution that was left out of the table.
    """

    radius: float
    height: tuple[float, float]
    share: tuple[float, float]
    load_excess: FloatArray
    indentation_excess: FloatArray
    error: float

    def solve(self, height: FloatArray, indentation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return contact radii [mm] and rescaled loads [mm^2] at indentations d [mm], (n,); 0 if open.

        Raises NotConverged if an indentation lies beyond what the table can continue.
        """
        open_ = indentation <= 0.0
        d, h = np.where(open_, 1.0, indentation), height
        foot = np.sqrt(h * (2.0 * self.radius - h))
        a = np.sqrt(self.radius * d)
        for _ in range(NEWTON_STEPS):
            step = 1e-6 * a
            value, ahead = (self._indentation(h, x, foot) for x in (a, a + step))
            change = (d - value) * step / (ahead - value)
            a = np.where(a + change > 0.0, a + change, 0.5 * a)
            if (np.abs(change[~open_]) <= 1e-13 * a[~open_]).all():
                break
        else:
            raise NotConverged("the table of caps cannot be continued to this indentation", a)
        load = Hertz().load(a, self.radius) * (1.0 + a / foot * self._excess(self.load_excess, h, a / foot))
        return np.where(open_, 0.0, a), np.where(open_, 0.0, load)

    def _indentation(self, h: FloatArray, a: FloatArray, foot: FloatArray) -> FloatArray:
        share = a / foot
        return a**2 / self.radius * (1.0 + share * self._excess(self.indentation_excess, h, share))

    def _excess(self, table: FloatArray, h: FloatArray, share: FloatArray) -> FloatArray:
        return np.asarray(
            np.polynomial.polynomial.polyval2d(_scaled(h, self.height), _scaled(share, self.share), table)
        )


@dataclass(frozen=True, eq=False)
class Caps:
    """The caps of a surface: a table for each radius of those that touch.

    Attributes
    ----------
    surface : Surface
    tables : tuple of CapContact
        One a radius.
    table : ndarray of int, (n,)
        Which of them holds for each asperity; -1 where no asperity of its radius touches.
    """

    surface: Surface
    tables: tuple[CapContact, ...]
    table: IntArray

    @property
    def error(self) -> float:
        """Largest error of the tables."""
        return max(table.error for table in self.tables)

    def solve(self, indentation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return contact radii [mm] and rescaled loads [mm^2] at indentations d [mm], (n,); 0 if open.

        Those without a table follow Hertz's law, from beyond the indentations asked for.
        """
        depth = np.maximum(indentation, 0.0)
        a = Hertz().contact_radius(depth, self.surface.radius)
        load = Hertz().load(a, self.surface.radius)
        for k, table in enumerate(self.tables):
            its = self.table == k
            a[its], load[its] = table.solve(self.surface.height[its], indentation[its])
        return a, load


def caps_of(surface: Surface, indentation: FloatArray) -> Caps:
    """Press the caps of each radius by finite elements, for contacts up to given indentations (n,) [mm].

    Raises
    ------
    InvalidInput
        If more than four radii touch, and where `cap_contact` does.
    """
    radii = np.unique(surface.radius[indentation > 0.0])
    if len(radii) > MOST_RADII:
        raise InvalidInput(
            f"the summits in contact have {len(radii)} different radii; "
            f"the caps of at most {MOST_RADII} are pressed"
        )
    tables, table = [], np.full(surface.count, -1)
    for k, radius in enumerate(radii):
        its = surface.radius == radius
        part = surface.replaced(
            position=surface.position[its], height=surface.height[its], radius=float(radius)
        )
        tables.append(cap_contact(part, indentation[its]))
        table[its] = k
    return Caps(surface, tuple(tables), table)


def cap_contact(surface: Surface, indentation: FloatArray) -> CapContact:
    """Press the caps of a surface by finite elements, for contacts up to given indentations (n,) [mm].

    Each is the true spherical cap on a bonded cylinder of the block's thickness and base area, with a
    free side; incompressible or not as the material is; small strain.

    Raises
    ------
    InvalidInput
        If the surface has no block, or summits that touch are no caps of one radius with 0 < h <= R.
    """
    touching = indentation > 0.0
    block, radius = surface.block, float(surface.radius[touching][0])
    if block is None:
        raise InvalidInput("the surface has no block")
    if np.ptp(surface.radius[touching]) > 0.0:
        raise InvalidInput("the summits differ in their radii")
    heights = surface.height[touching]
    if heights.min() <= 0.0 or heights.max() > radius:
        raise InvalidInput("a summit in contact is no cap: its height must lie between 0 and its radius")
    foot = np.sqrt(heights * (2.0 * radius - heights))
    share = np.sqrt(radius * indentation[touching]) / foot
    low, high = float(heights.min()), float(heights.max())
    # a contact that has just closed is Hertz's; a tenth of the range keeps the smallest ones meshable
    ranges = (low, high), (0.1 * float(share.max()), min(float(share.max()), 0.9))
    side = math.sqrt(block.width * block.length / math.pi)

    def excess(h: float, s: float) -> tuple[float, float]:
        from metafem.fe import press

        foot = math.sqrt(h * (2.0 * radius - h))
        a = s * foot
        contact = press(
            a,
            radius,
            surface.material.poisson_ratio,
            height=h,
            thickness=block.thickness,
            block_radius=side,
        )
        load = contact.rescaled_load / float(Hertz().load(a, radius))
        return (load - 1.0) / s, (contact.indentation * radius / a**2 - 1.0) / s

    h_nodes = _nodes(*ranges[0], HEIGHT_NODES if high > low else 1)
    s_nodes = _nodes(*ranges[1], SHARE_NODES)
    pairs = [(h, s) for h in h_nodes for s in s_nodes]
    pressed = [excess(h, s) for h, s in each("finite elements of a cap", pairs)]
    found = np.array(pressed).reshape(len(h_nodes), len(s_nodes), 2)
    tables = []
    for k in (0, 1):
        by_height = np.vander(_scaled(h_nodes, ranges[0]), increasing=True)
        by_share = np.vander(_scaled(s_nodes, ranges[1]), increasing=True)
        tables.append(np.linalg.solve(by_height, found[:, :, k]) @ np.linalg.inv(by_share).T)
    loads, indentations = tables
    bare = CapContact(radius, ranges[0], ranges[1], loads, indentations, math.nan)
    # between the nodes, where both polynomials are near their worst
    place = np.array([0.75 * low + 0.25 * high, 0.6 * ranges[1][1]])
    error = max(
        abs(s_excess - float(bare._excess(table, place[0], place[1]))) * place[1]
        for s_excess, table in zip(excess(*place), tables, strict=True)
    )
    return replace(bare, error=error)


def _nodes(low: float, high: float, count: int) -> FloatArray:
    """Return Chebyshev's nodes of an interval."""
    angle = math.pi * (np.arange(count) + 0.5) / count
    return np.asarray(0.5 * (low + high) - 0.5 * (high - low) * np.cos(angle))


def _scaled(value: FloatArray, interval: tuple[float, float]) -> FloatArray:
    low, high = interval
    return np.asarray((2.0 * value - low - high) / (high - low) if high > low else np.zeros_like(value))
