"""Tables of contact laws for the compiled kernels."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from functools import lru_cache
from typing import Any, NamedTuple, cast

import numpy as np
from numpy.polynomial import chebyshev
from scipy.optimize import brentq

from metafem._kernels.contact import tabulated as kernel
from metafem._kernels.contact.tabulated import BY_DEPTH, HEADER, LEVER_EDGE, Law, tilted
from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.contact.by_profile import MixedCaps
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import contacts

# Degree of the polynomials in a panel, and a bound for the coefficients of the last two degrees. If they are
# smaller, the panel resolves the logarithm of a function to ten times its rounding error.
DEGREE, RESOLVED = 7, 3e-14

# Largest width of a panel in the logarithm, and number of halvings with the bound above: they resolve a law
# computed by quadrature to its rounding errors.
WIDEST, MOST_HALVINGS = 3.0, 7

# Looser bound after these halvings, above the rounding errors of a quadrature, and the maximum number of all
# halvings. More halvings are needed near the equator of a sphere, where its load grows without limit.
POLE, HALVINGS_AT_A_POLE = 1e-11, 14

# Smallest contact radius of a table, divided by its scale. Below it every smooth law is a power law to
# rounding.
SMALLEST = 1e-8

# Smallest indentation of a table, divided by its scale. Products of powers up to 32 are then far above
# underflow.
LIGHTEST = 1e-60

# Largest indentation of a table, divided by its scale, for laws without a limit of the indentation.
DEEPEST = 4.0

# Contact radii that differ relatively by less than this are treated as one edge of a panel.
SAME = 1e-9

# Smallest slope D' at the edge of a contact for which the moment T(p) of a tilted contact follows the law. At
# smaller slopes T is proportional to the load; otherwise the tilt of a flat summit would grow without limit
# as its load vanishes. The slopes of the neighbours' fields reach this value when the contact radius is a
# fifth of the distance between contacts.
FLATTEST = 0.005

# Chebyshev nodes from -1 to 1, the matrix from values at the nodes to Chebyshev coefficients, the number of
# Gauss points between two nodes, and the matrix from Chebyshev coefficients to coefficients of powers.
NODES = np.cos(np.pi * np.arange(DEGREE, -1, -1) / DEGREE)
TO_CHEBYSHEV = np.linalg.inv(chebyshev.chebvander(NODES, DEGREE)).T
GAUSS = 8
TO_POWERS = np.array(
    [np.pad(chebyshev.cheb2poly(row), (0, DEGREE + 1))[: DEGREE + 1] for row in np.eye(DEGREE + 1)]
)

# Bins per panel; the kernels find the panel of an argument from its bin. Panels of a sphere or a profile are
# narrow at one end; with 2 bins their contacts take 12 % longer than those of a power law, with 8 bins 4 %.
BINS = 8

# Number of cached sets of tables, for a quarter of the number of cached tables: a table takes milliseconds to
# compute and about 30 kB.
KEPT = 64


class _Fit(NamedTuple):
    """Piecewise polynomials for several functions of a logarithm."""

    edge: FloatArray  # (m + 1,)
    value: FloatArray  # Chebyshev coefficients (m, functions, DEGREE + 1)

    def row(self) -> FloatArray:
        """Return the panels in the layout that `_kernels.contact.tabulated` reads."""
        panels = len(self.value)
        bins = BINS * panels
        width = (self.edge[-1] - self.edge[0]) / bins
        first = np.searchsorted(self.edge[1:-1], self.edge[0] + width * np.arange(bins), side="right")
        head = np.array([panels, bins, self.edge[0], 1.0 / width])
        rows = (self.value @ TO_POWERS).reshape(panels, -1)
        inverse = 2.0 / np.diff(self.edge)
        return np.concatenate([head, first, self.edge, np.column_stack([inverse, rows]).ravel()])


def tables(law: Contact, radius: FloatArray) -> Law:
    """Return the tables of a law for unit E* and radii (..., n) [mm], as the kernels read them."""
    if isinstance(law, MixedCaps):
        return _mixed(law, radius)
    size = np.array(radius, dtype=np.float64, order="C")
    if law == PARABOLOID:
        return Law(size, np.full(size.shape, -1), size, np.empty((0, 0)))
    which = np.zeros(size.shape, dtype=np.int64)
    keys = _keys(law, size, which)
    if isinstance(law, Hashable):
        return Law(size, which, size, _kept(tuple(keys)))
    return Law(size, which, size, _stacked([_table(*key) for key in keys]))


def _mixed(law: MixedCaps, summits: Any) -> Law:
    """Return the tables of caps that differ, for `SUMMIT` records (..., n)."""
    size = np.ascontiguousarray(summits["radius"])
    which, keys = np.zeros(size.shape, dtype=np.int64), list[tuple[Contact, float]]()
    for k, own in enumerate(law.laws):
        mine = summits["cap"] == k
        if mine.any():
            some = np.zeros(int(mine.sum()), dtype=np.int64)
            found = _keys(own, size[mine], some)
            which[mine] = some + len(keys)
            keys += found
    return Law(size, which, size, _kept(tuple(keys)))


def _keys(law: Contact, size: FloatArray, which: IntArray) -> list[tuple[Contact, float]]:
    """Return law and radius of each table for asperities with radii (..., n), and fill their indices."""
    if law.similar:
        return [(law, 1.0)]
    kinds, inverse = np.unique(size, return_inverse=True)
    which += inverse.reshape(size.shape)
    return [(law, float(kind)) for kind in kinds]


def rows_of(law: Law, rows: int | slice) -> Law:
    """Return the tables for some rows of surfaces with radii (m, n)."""
    return law._replace(radius=law.radius[rows], which=law.which[rows], scale=law.scale[rows])


def deepest(law: Law) -> FloatArray:
    """Return the largest indentation [mm] that the table of each asperity covers."""
    if not law.data.size:
        return np.full(law.which.shape, math.inf)
    return np.asarray(law.data[law.which, kernel.DEEPEST] * law.scale)


def _stacked(tables: list[FloatArray]) -> FloatArray:
    """Return an array with one table in each row, padded with zeros to the longest."""
    size = max(len(row) for row in tables)
    return np.stack([np.pad(row, (0, size - len(row))) for row in tables])


@lru_cache(maxsize=KEPT)
def _kept(keys: tuple[Hashable, ...]) -> FloatArray:
    return _stacked([_one(key) for key in keys])


@lru_cache(maxsize=4 * KEPT)
def _one(key: Hashable) -> FloatArray:
    return _table(*cast("tuple[Contact, float]", key))


def _table(law: Contact, radius: float) -> FloatArray:
    """Return the table of a law for one radius [mm]."""
    end = float(law.largest_indentation(radius))
    last = end if math.isfinite(end) else DEEPEST * radius
    ends = law.contact_radius(np.array([LIGHTEST * radius, last]), radius)
    ends[0] = max(ends[0], SMALLEST * radius)
    breaks = law.breaks(radius)
    inside = (breaks > ends[0] * (1.0 + SAME)) & (breaks < ends[1] * (1.0 - SAME))
    edge = np.concatenate([ends[:1], breaks[inside], ends[1:]])
    edge = edge[np.append(True, edge[1:] > edge[:-1] * (1.0 + SAME))]

    def by_depth(x: FloatArray) -> FloatArray:
        found = contacts(law, radius * np.exp(x), np.array(radius))
        return np.log(np.stack([found.load / radius**2, found.area / (math.pi * radius**2)]))

    def by_radius(y: FloatArray) -> FloatArray:
        a = radius * np.exp(y)
        parts = law.indentation(a, radius), law.load(a, radius), law.second_moment(a, radius)
        return np.log([part / radius**power for part, power in zip(parts, (1, 2, 4), strict=True)])

    depth = np.log(law.indentation(edge, radius) / radius)
    depth[-1] = math.log(last / radius)
    own = _fitted(by_depth, depth)
    own = own._replace(value=np.concatenate([own.value, _energy(own)[:, None]], axis=1))
    elastic = _fitted(by_radius, np.log(edge / radius)) if law.largest_order > 1 else None
    straight = float(np.abs(own.value[-1, :, 2:]).max()) < RESOLVED
    most = math.inf if straight and math.isinf(end) else last / radius
    parts = [own.row()] if elastic is None else [own.row(), elastic.row()]
    begin = [HEADER, HEADER + len(parts[0])]
    table = np.concatenate([[most, 0.0, 0.0, 0.0, *begin], *parts])
    if elastic is None:
        return table
    # D' = 2 pi a/(dA/dd) increases with the contact radius
    a = np.geomspace(float(ends[0]), float(ends[1]), 4000)
    flat = np.flatnonzero(2.0 * math.pi * a / law.area_slope(a, radius) < FLATTEST)
    if flat.size:
        z = float(law.indentation(_edge(law, radius, a[flat[-1] :]), radius)) / radius
        load, _, _, _, lever, rate, _ = tilted(table[None], 0, 1.0, z)
        table[LEVER_EDGE:BY_DEPTH] = load, 0.5 * rate, 0.5 * (rate * load - lever)
    return table


def _edge(law: Contact, radius: float, a: FloatArray) -> float:
    """Return the contact radius at which the slope D' is `FLATTEST`, between the first two values of a."""
    if len(a) == 1:
        return float(a[0])

    def excess(a: float) -> float:
        return 2.0 * math.pi * a / float(law.area_slope(a, radius)) - FLATTEST

    return float(brentq(excess, a[0], a[1], xtol=1e-15 * a[0], rtol=1e-15))


def _fitted(functions: Callable[[FloatArray], FloatArray], ends: FloatArray) -> _Fit:
    """Return polynomials that resolve functions of x, in panels between the given ends."""
    low, high = ends[:-1], ends[1:]
    done: list[tuple[FloatArray, FloatArray, FloatArray]] = []
    pieces = np.maximum(np.ceil((high - low) / WIDEST), 1.0).astype(int)
    low, high = (
        np.concatenate([low[i] + (high[i] - low[i]) * (np.arange(n) + j) / n for i, n in enumerate(pieces)])
        for j in (0, 1)
    )
    for halvings in range(HALVINGS_AT_A_POLE + 1):
        half, middle = 0.5 * (high - low), 0.5 * (high + low)
        value = np.moveaxis(functions(middle[:, None] + half[:, None] * NODES) @ TO_CHEBYSHEV, 0, 1)
        last = np.abs(value[..., -2:]).max(axis=(1, 2))
        rough = last > (RESOLVED if halvings < MOST_HALVINGS else POLE)
        rough &= halvings < HALVINGS_AT_A_POLE
        done.append((low[~rough], high[~rough], value[~rough]))
        if not rough.any():
            break
        low, high = (
            np.concatenate([low[rough], middle[rough]]),
            np.concatenate([middle[rough], high[rough]]),
        )
    low, value = (np.concatenate([part[i] for part in done]) for i in (0, 2))
    order = np.argsort(low)
    return _Fit(np.append(low[order], ends[-1]), value[order])


def _energy(fit: _Fit) -> FloatArray:
    """Return polynomials for the logarithm of the energy ``int_0^z z dp = z p - int_0^z p dz``."""
    half, middle = 0.5 * np.diff(fit.edge), 0.5 * (fit.edge[1:] + fit.edge[:-1])
    load = fit.value[:, 0]
    point, weight = np.polynomial.legendre.leggauss(GAUSS)
    width = 0.5 * np.diff(NODES)
    t = 0.5 * (NODES[1:] + NODES[:-1])[:, None] + width[:, None] * point  # (DEGREE, GAUSS)
    inside = chebyshev.chebval(t, load.T)  # (m, DEGREE, GAUSS)
    steps = (
        (np.exp(inside + middle[:, None, None] + half[:, None, None] * t) @ weight) * width * half[:, None]
    )
    at = middle[:, None] + half[:, None] * NODES
    whole = np.exp(chebyshev.chebval(NODES, load.T) + at)  # z p at the nodes
    power = chebyshev.chebval(-1.0, chebyshev.chebder(load[0])) / half[0]
    before = whole[0, 0] / (1.0 + power)
    start = before + np.concatenate([[0.0], np.cumsum(steps.sum(axis=1))[:-1]])
    total = start[:, None] + np.concatenate([np.zeros((len(half), 1)), np.cumsum(steps, axis=1)], axis=1)
    return np.asarray(np.log(whole - total) @ TO_CHEBYSHEV)
