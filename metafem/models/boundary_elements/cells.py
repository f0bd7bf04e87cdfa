"""A scene, patches of cells around its contacts, and loads and areas of the contacts; lengths in cells.

The origin of the common grid is the centre of the bounding box of all summits, so that the grid moves with
the surface. Cell (i, j) has its centre at (i, j).
"""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact, Hertz
from metafem.contact.elastic import PARABOLOID, Elastic
from metafem.contact.law import area_change, sizes_of
from metafem.errors import refuse_if
from metafem.models._resources import require_memory
from metafem.models.boundary_elements.influence import convergence_rate
from metafem.substrate import Radial
from metafem.surface import Surface

# Boxes are merged into one patch if each term of the expansion between them reduces the error by less than
# this factor. At this rate 23 terms per side are needed for the tolerance of the far field, and their table
# costs as much as the patch.
SLOWEST_RATE = 2.4

# Between two caps a groove stays open, which the cells close where it is narrower than they are: the error of
# the area increases with the length of the grooves, measured by pairs of cells this far apart.
NARROW = 4


BoolArray = NDArray[np.bool_]

# A rectangle of cells around one contact or several close ones: the grid indices of its first cell (2,), the
# depths of the undeformed surface below the tallest summit, and the asperity with the highest surface in each
# cell, both (rows, columns).
Patch = tuple[IntArray, FloatArray, IntArray]


class Scene:
    """One surface on one substrate, with the data that are common to all loads.

    Positions (n, 2), summit depths (n,) and radii (n,) of the asperities are in cells.
    """

    def __init__(self, surface: Surface, cell: float, substrate: Radial, law: Contact) -> None:
        """Prepare a surface; cell: side of the cells [mm]; law: contact law that is bound to the surface."""
        refuse_if(
            surface.cell is not None,
            "contacts in a periodic cell cannot be resolved; use metafem.Interacting()",
        )
        self.surface, self.cell, self.law = surface, cell, cast("Hertz | Elastic", law)
        self.substrate = substrate.for_surface(surface)
        low, high = surface.position.min(axis=0), surface.position.max(axis=0)
        # relative to the corner, so that no digits are lost if the surface is far from the origin
        self.position: FloatArray = ((surface.position - low) - 0.5 * (high - low)) / cell
        self.depth = surface.gap / cell
        self.of_law = law.summits(surface)  # what the law takes as the radius of each asperity, (n,) [mm]
        self.radius = sizes_of(self.of_law) / cell
        self.paraboloids = law == PARABOLOID  # for which closed forms exist
        # matrices over all pairs of asperities at once: the influence, its derivatives, the distances and the
        # convergence rates of the expansions
        require_memory(8 * 16 * surface.count**2, f"{surface.count} asperities")
        self.coupling, self.slope_x, self.slope_y, _ = self.substrate.influence_terms(surface)
        functions = (self.substrate.influence, self.substrate.regular)
        self.of_cells = [lambda r, f=f: np.asarray(cell * f(cell * r)) for f in functions]

    def widest(self) -> FloatArray:
        """Return the largest contact radii that the law describes, (n,); 10 R deep if it has no limit."""
        most = self.law.largest_indentation(self.of_law)
        deepest = np.where(np.isfinite(most), most, 10.0 * self.cell * self.radius)
        return np.asarray(self.law.contact_radius(deepest, self.of_law) / self.cell)

    def largest(self, indentation: FloatArray) -> float:
        """Return the largest contact radius [mm] at indentations (n,) [mm]."""
        return float(self.law.contact_radius(indentation, self.of_law).max())

    def patch(self, members: IntArray, first: IntArray, last: IntArray) -> Patch:
        """Return the `Patch` with the cells from `first` to `last`, on which these summits have contacts."""
        inside = np.flatnonzero(((self.position >= first) & (self.position <= last)).all(axis=1))
        x, y = (np.arange(a, b + 1, dtype=np.float64) for a, b in zip(first, last, strict=True))
        gap = np.full((len(x), len(y)), np.inf)
        owner = np.zeros(gap.shape, dtype=np.int64)
        for i in np.union1d(members, inside):
            cx, cy = self.position[i]
            rho = self.cell * np.hypot((x - cx)[:, None], y - cy)
            depth = self.depth[i] + self.law.depth_at(rho, self.of_law[i]) / self.cell
            higher = depth < gap
            gap[higher] = depth[higher]
            owner[higher] = i
        return first, gap, owner

    def areas(self, spread: FloatArray, load: FloatArray, shift: FloatArray) -> FloatArray:
        """Return the areas of contacts with loads P and second moments M = 2 s P of the pressure, (n,).

        M is about the centroid, and s = sqrt(<x^2><y^2> - <xy>^2); a Hertzian ellipse has the area 5 pi s.
        shift: distances from the summits to the centroids of the pressure.

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
        for _ in range(52):  # down to rounding
            a = 0.5 * (low + high)
            alone = self.law.load(a, radius)
            own = self.law.second_moment(a, radius) - 0.4 * a**2 * alone
            # neighbours flatten the summit: alone, a contact of this radius carries at most twice the load,
            # up to which the equation is monotonic for all power caps
            wide = (own > moment - 0.4 * a**2 * carried) | (alone > 2.0 * carried)
            low, high = np.where(wide, low, a), np.where(wide, a, high)
        closed = low > 1e-12 * widest  # pressure on one cell has no moment
        a, carried = np.where(closed, low, 0.5 * widest), np.where(closed, carried, 1.0)
        slope, own = carried * self.cell * shift / (4.0 / 3.0 * a**3), self.law.profile_slope(a, radius)
        seen = (10.0 - 20.0 / 3.0 * a**2 * own / self.law.load(a, radius)) * (slope / own) ** 2
        change = np.maximum(1.0 + area_change(self.law, a, radius, slope) - seen, 0.0)
        return np.where(closed, math.pi * (a / self.cell) ** 2 * change, 0.0)


def boxes(position: FloatArray, half_width: FloatArray) -> tuple[list[IntArray], IntArray, IntArray]:
    """Return the members (summits), first cells (m, 2) and last cells (m, 2) of m patches, sorted by shape.

    half_width: half the width of the box of cells around each summit, (n,); 0 if it has no cells.
    """
    used = np.flatnonzero(half_width > 0.0)
    first = np.floor(position[used] - half_width[used, None]).astype(np.int64)
    last = np.ceil(position[used] + half_width[used, None]).astype(np.int64)
    last += (first - last - 1) % 4  # few shapes, whose products are computed together
    members = [np.array([i]) for i in used]
    while len(members) > 1:
        rate = convergence_rate(first, last)
        a, b = np.nonzero(np.triu(rate < SLOWEST_RATE, 1))
        if a.size == 0:
            break
        graph = coo_array((np.ones(a.size), (a, b)), shape=rate.shape)
        count, group = connected_components(graph, directed=False)
        groups = [np.flatnonzero(group == k) for k in range(count)]
        first = np.array([first[g].min(axis=0) for g in groups])
        last = np.array([last[g].max(axis=0) for g in groups])
        members = [np.concatenate([members[i] for i in g]) for g in groups]
    place = np.lexsort((last - first).T)
    return [members[k] for k in place], first[place], last[place]


def measure(
    patches: list[Patch], pressure: list[FloatArray], scene: Scene
) -> tuple[FloatArray, FloatArray, BoolArray, FloatArray, IntArray, int]:
    """Return what the pressures on the cells of each patch carry.

    The loads and the contact areas on the cells in which each asperity is the highest, (n,); whether
    its area is that within the edge instead of the law's for the second moments, (n,); by how many
    cells the law's for the mean pressure differs from the latter, (n,), 0 for other caps than
    paraboloids; the pairs of asperities with adjacent cells in contact, (m, 2); and the number of pairs
    of cells of two asperities, `NARROW` apart.
    """
    count = len(scene.radius)
    sums, area, pairs, grooves = np.zeros((7, count)), np.zeros(count), [], 0
    for (corner, _, owner), p in zip(patches, pressure, strict=True):
        closed = p > 0.0
        for a, b in _neighbours(1):
            met = closed[a] & closed[b] & (owner[a] != owner[b])
            pairs.append(np.stack([owner[a][met], owner[b][met]], axis=1))
        for a, b in _neighbours(NARROW):
            grooves += int((closed[a] & closed[b] & (owner[a] != owner[b])).sum())
        cells, of = np.argwhere(closed), owner[closed]
        x, y = (cells + corner - scene.position[of]).T
        for k, factor in enumerate((1.0, x, y, x**2, y**2, x * y, p[closed])):
            sums[k] += np.bincount(of, p[closed] * factor, count)
        area += _within_edges(p, owner, count)
    load, carries = sums[0], sums[0] > 0.0
    x, y, xx, yy, xy, power = sums[1:] / np.where(carries, load, 1.0)
    square = (xx - x**2) * (yy - y**2) - (xy - x * y) ** 2
    # the moments of collocated pressures miss half a cell of the area: .4 to .6 for Hertz contacts of 5 to 80
    # cells per radius at any offset from the grid, .3 for 4; 0 to 1.1 for powers from 1.2 to 8
    spread = np.sqrt(np.maximum(square, 0.0)) + 0.5 / (5.0 * math.pi) * carries
    lawful = scene.areas(spread, load, np.hypot(x, y))
    merged = np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)
    # the pressure of a Hertz contact, linear in its square, has this area, with a smaller error than the edge
    ellipse = 9.0 / 8.0 * load / np.where(carries, power, 1.0)
    # .3 to 1.3 cells less for Hertz contacts of 5 to 80 cells per radius
    apart = np.abs(ellipse - lawful + 0.6) * scene.paraboloids
    deformed = np.abs(area - lawful) > allowed(lawful, scene.paraboloids)
    deformed |= apart > 1.1 + 0.003 * np.sqrt(4.0 * math.pi * lawful)
    deformed[merged.ravel()] = True
    return load, np.where(deformed, area, lawful), deformed, apart, merged, grooves


def _neighbours(apart: int) -> tuple[tuple[Any, Any], ...]:
    """Return slices of two grids of cells that are so many cells apart, along rows and along columns."""
    ahead, behind = slice(apart, None), slice(None, -apart)
    return (np.s_[ahead, :], np.s_[behind, :]), (np.s_[:, ahead], np.s_[:, behind])


def allowed(area: FloatArray, paraboloids: bool) -> FloatArray:
    """Return the error of areas within the edge, in cells, with which contacts may have their law's shape.

    Hertz contacts of 5 to 80 cells per radius differ by -2 to 4.6 cells. Powers from 1.2 to 8, whose
    pressure is steep near the edge or near the axis, are met within it.
    """
    edge = np.sqrt(4.0 * math.pi * area)
    return np.asarray(5.0 + 0.005 * edge if paraboloids else 8.0 + 0.02 * edge)


def _within_edges(pressure: FloatArray, owner: IntArray, count: int) -> FloatArray:
    """Return the contact area within the edges on the cells of each asperity, (n,).

    Near an edge p^2 increases linearly with the distance x, so that p^2 divided by its slope is x. The weight
    H(t) of a cell with t = x/3 up to 1 vanishes at the edge, so that a cell that opens or closes causes
    no jump. Its mean over the rim is 1, and int H' t^2 dt = 0, so that a curved p^2(x) has no effect.
    """
    closed, square = np.pad(pressure > 0.0, 1), np.pad(pressure, 1) ** 2
    slope = 3.0 * np.hypot(*np.gradient(square))
    near = (slope > square) & ~binary_erosion(closed, iterations=5)  # the rim along diagonals too
    t = np.divide(square, slope, out=np.ones_like(square), where=near)
    edges = sum(closed & ~np.roll(closed, step, axis) for axis in (0, 1) for step in (1, -1))
    weight = closed * (9.0 * t - 18.0 * t**2 + 10.0 * t**3)
    # edges of cells are longer than a curved line by 4/pi in the mean; that of the weighted area is .04 cells
    # beyond the true one, for Hertz contacts of 4 to 80 cells per radius
    share = weight - 0.25 * math.pi * 0.04 * np.asarray(edges)
    return np.maximum(np.bincount(owner.ravel(), share[1:-1, 1:-1].ravel(), count), 0.0)
