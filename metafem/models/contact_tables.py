"""Tables of contact laws for the compiled kernels."""

from __future__ import annotations

import math
from collections.abc import Callable, Hashable
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.interpolate import PPoly, make_interp_spline
from scipy.optimize import brentq

from metafem._kernels.contact import tabulated as kernel
from metafem._kernels.contact.tabulated import Law
from metafem._validate import FloatArray
from metafem.caps import Caps
from metafem.contact import Contact, Elastic
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import contacts

# Relative error of a table, and the number of times that the spacing of its points is halved at most, from 1
# in the logarithm. A sphere needs 5 halvings; the cubics of a table stop at the last, 1e-8 off.
RESOLVED, HALVINGS = 1e-10, 6

# Smallest contact radius and smallest indentation of a table over its scale: below the first, smooth laws are
# powers within 1e-9; above the second, products of powers up to 32 do not underflow.
SMALLEST, LIGHTEST = 1e-9, 1e-60

# Largest indentation of a table over its scale, for laws without an end, which are powers above.
DEEPEST = 4.0

# Contact radii that differ relatively by less than this are treated as one edge of a panel.
SAME = 1e-9

# Smallest slope D' at the edge of a contact for which the moment T(p) of a tilted contact follows the law. At
# smaller slopes T is proportional to the load; otherwise the tilt of a flat summit would grow without limit
# as its load vanishes. The slopes of the neighbours' fields reach this value when the contact radius is a
# fifth of the distance between contacts.
FLATTEST = 0.005


def tables(law: Contact, radius: Any) -> Law:
    """Return the tables of a law for unit E* and radii (..., n) [mm], as the kernels read them."""
    if law == PARABOLOID:
        size = np.array(radius, dtype=np.float64, order="C")
        return Law(size, np.full(size.shape, -1), size, np.empty((0, 0)))
    mixed = isinstance(law, Elastic) and isinstance(law.cap, Caps)
    size = np.array(radius["radius"] if mixed else radius, dtype=np.float64, order="C")
    which, keys = np.zeros(size.shape, dtype=np.int64), list[tuple[Contact, float]]()
    laws: list[Contact] = [Elastic(cap) for cap in law.cap.kinds] if mixed else [law]  # type: ignore[attr-defined]
    for k, one in enumerate(laws):
        own = radius["cap"] == k if mixed else np.full(size.shape, True)
        kinds, inverse = np.unique(size[own], return_inverse=True)
        which[own] = len(keys) + (0 if one.similar else inverse)
        keys += [(one, 1.0)] if one.similar else [(one, float(kind)) for kind in kinds]
    kept = _kept if isinstance(law, Hashable) else _kept.__wrapped__
    return Law(size, which, size, kept(tuple(keys)))


def rows_of(law: Law, rows: int | slice) -> Law:
    """Return the tables for some rows of surfaces with radii (m, n)."""
    return law._replace(radius=law.radius[rows], which=law.which[rows], scale=law.scale[rows])


def deepest(law: Law) -> FloatArray:
    """Return the largest indentation [mm] that the table of each asperity covers."""
    if not law.data.size:
        return np.full(law.which.shape, math.inf)
    return np.asarray(law.data[law.which, kernel.DEEPEST] * law.scale)


@lru_cache(maxsize=64)
def _kept(keys: tuple[tuple[Any, float], ...]) -> FloatArray:
    """Return an array with one table in each row, padded with zeros to the longest."""
    found = [_one(*key) if isinstance(key[0], Hashable) else _one.__wrapped__(*key) for key in keys]
    size = max(map(len, found))
    return np.stack([np.pad(row, (0, size - len(row))) for row in found])


@lru_cache(maxsize=256)
def _one(law: Any, radius: float) -> FloatArray:
    """Return the table of a law for one radius [mm]; it takes milliseconds to compute and about 100 kB."""
    end = float(law.largest_indentation(radius))
    last = end if math.isfinite(end) else DEEPEST * radius
    ends = law.contact_radius(np.array([LIGHTEST * radius, last]), radius)
    ends[0] = max(ends[0], SMALLEST * radius)
    breaks = law.breaks(radius)
    inside = breaks[(breaks > ends[0] * (1.0 + SAME)) & (breaks < ends[1] * (1.0 - SAME))]
    edge = np.log(law.indentation(np.concatenate([ends[:1], inside, ends[1:]]), radius) / radius)
    edge[-1] = math.log(last / radius)
    if len(edge) == 2:  # near the end of a cap its functions vary fast, at small indentations they are powers
        edge = np.insert(edge, 1, edge[-1] - 4.0)

    def functions(x: FloatArray) -> FloatArray:
        """Return ln p, ln a^2 and ln M (n, functions) at ln z, all over the radius."""
        found = contacts(law, radius * np.exp(x), np.array(radius))
        parts = [found.load / radius**2, found.area / (math.pi * radius**2)]
        if law.largest_order > 1:
            parts.append(law.second_moment(found.contact_radius, radius) / radius**4)
        return np.log(np.stack(parts, axis=-1))

    points = [_resolved(functions, *ends) for ends in pairwise(edge)]
    energy = _energy([_spline(x, y) for x, y in points])
    columns = [np.insert(y, 2, own, axis=1) for (_, y), own in zip(points, energy, strict=True)]
    splines = [_spline(x, y) for (x, _), y in zip(points, columns, strict=True)]
    edges = np.append(np.concatenate([spline.x[:-1] for spline in splines]), edge[-1])
    panels = np.concatenate([spline.c for spline in splines], axis=1)[::-1].transpose(1, 2, 0)
    data = np.zeros((len(panels), kernel.FUNCTIONS, kernel.COEFFICIENTS))
    data[:, : panels.shape[1]] = panels
    bins = 2 * len(panels)
    width = (edges[-1] - edges[0]) / bins
    first = np.searchsorted(edges[1:-1], edges[0] + width * np.arange(bins), side="right")
    straight = not math.isfinite(end) and np.abs(data[-1, :, 2:]).max() < RESOLVED
    most = math.inf if straight else last / radius
    head = [most, 0.0, 0.0, 0.0, len(panels), bins, edges[0], 1.0 / width]
    table = np.concatenate([head, first, edges, data.ravel()])
    if law.largest_order > 1:
        table[kernel.LEVER_EDGE : kernel.PANELS] = _flat(law, radius, ends, table)
    return table


def _flat(law: Contact, radius: float, ends: FloatArray, table: FloatArray) -> tuple[float, float, float]:
    """Return the load at which D' is `FLATTEST`, and slope and offset of T(p) below and above it."""

    def excess(y: float) -> float:
        a = math.exp(y)  # D' = 2 pi a/(dA/dd) increases with the contact radius
        return 2.0 * math.pi * a / float(law.area_slope(a, radius)) - FLATTEST

    low, high = np.log(ends)
    if excess(low) >= 0.0:
        return 0.0, 0.0, 0.0
    a = math.exp(high if excess(high) < 0.0 else brentq(excess, low, high))
    load, _, _, _, lever, rate, _ = kernel.tilted(
        table[None], 0, 1.0, float(law.indentation(a, radius)) / radius
    )
    return load, 0.5 * rate, 0.5 * (rate * load - lever)


def _spline(x: FloatArray, y: FloatArray) -> PPoly:
    """Return a quintic spline through points as polynomials between these points."""
    spline = make_interp_spline(x, y, k=kernel.COEFFICIENTS - 1)
    parts = [spline(x[:-1], k) / math.factorial(k) for k in range(kernel.COEFFICIENTS)]
    return PPoly(np.array(parts[::-1]), x)


def _resolved(
    functions: Callable[[FloatArray], FloatArray], low: float, high: float
) -> tuple[FloatArray, FloatArray]:
    """Return points x and the values of functions there, between which quintic splines resolve them."""
    count = max(math.ceil(high - low), kernel.COEFFICIENTS)
    x = np.linspace(low, high, count + 1)
    y = functions(x)
    for _ in range(HALVINGS):
        middle = 0.5 * (x[:-1] + x[1:])
        between = functions(middle)
        if np.abs(make_interp_spline(x, y, k=kernel.COEFFICIENTS - 1)(middle) - between).max() < RESOLVED:
            break
        places = np.arange(1, len(x))
        x, y = np.insert(x, places, middle), np.insert(y, places, between, axis=0)
    return x, y


def _energy(splines: list[PPoly]) -> list[FloatArray]:
    """Return the logarithm of ``int_0^z z dp = z p - int_0^z p dz`` at the points of splines of ln p, ..."""
    node, weight = np.polynomial.legendre.leggauss(8)
    found, before = [], -1.0
    for spline in splines:
        x, half = spline.x, 0.5 * np.diff(spline.x)[:, None]
        inside = x[:-1, None] + half * (node + 1.0)
        steps = (np.exp(spline(inside)[..., 0] + inside) * half) @ weight
        whole = np.exp(spline(x)[:, 0] + x)
        if before < 0.0:  # a power below the table
            before = whole[0] / (1.0 + float(spline(x[0], 1)[0]))
        under = before + np.concatenate([[0.0], np.cumsum(steps)])
        found.append(np.log(whole - under))
        before = under[-1]
    return found
