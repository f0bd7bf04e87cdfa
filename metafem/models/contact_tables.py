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

from metafem._kernels import law as kernel
from metafem._kernels.law import Law
from metafem._validate import FloatArray
from metafem.caps import Caps
from metafem.contact import Contact, Elastic
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import ROUNDING
from metafem.errors import InvalidInput

# Relative error of a table. A sphere needs 5 halvings of the spacing of its points, which is 1 in the
# logarithm at first; the cubics of a table stop at the last of 6 halvings, 1e-8 off.
RESOLVED = 1e-10

# Contact radii that differ relatively by less than this are treated as one edge of a segment.
SAME = 1e-9


def tables(law: Contact, radius: Any) -> Law:
    """Return the tables of a law for unit E* and radii (..., n) [mm], as the kernels read them."""
    mixed = isinstance(law, Elastic) and isinstance(law.cap, Caps)
    if not mixed and law == PARABOLOID:  # many caps take long to compare
        return kernel.hertz_law(np.array(radius, dtype=np.float64, order="C"))
    kept, kinds = (_kept, _kinds) if isinstance(law, Hashable) else (_kept.__wrapped__, _kinds.__wrapped__)
    size = np.array(radius["radius"] if mixed else radius, dtype=np.float64, order="C")
    laws, similar = kinds(law, kept)  # type: ignore[arg-type]
    which, keys = np.zeros(size.shape, dtype=np.int64), list[tuple[Contact, float]]()
    if similar is not None:
        which += radius["cap"] if mixed else 0
        return Law(size, which, size, similar)
    for k, one in enumerate(laws):
        own = radius["cap"] == k if mixed else np.full(size.shape, True)
        sizes, inverse = np.unique(size[own], return_inverse=True)
        which[own] = len(keys) + inverse
        keys += [(one, each) for each in sizes.tolist()]
    return Law(size, which, size, kept(tuple(keys)))


@lru_cache(maxsize=64)
def _kinds(law: Any, kept: Callable[..., FloatArray]) -> tuple[tuple[Contact, ...], FloatArray | None]:
    """Return the law of each kind of cap, and their tables if these serve for any radius."""
    cap = getattr(law, "cap", None)
    laws = tuple(Elastic(each) for each in cap.kinds) if isinstance(cap, Caps) else (law,)
    similar = all(one.similar for one in laws)
    return laws, kept(tuple((one, 1.0) for one in laws)) if similar else None


def rows_of(law: Law, rows: int | slice) -> Law:
    """Return the tables for some rows of surfaces with radii (m, n)."""
    return law._replace(radius=law.radius[rows], which=law.which[rows], scale=law.scale[rows])


def refuse_beyond(table: Law, indentation: FloatArray, law: Contact) -> None:
    """Raise InvalidInput if contacts with indentations (..., n) [mm] are deeper than their law describes."""
    if not table.data.size:
        return
    most = table.data[table.which, 0] * table.scale
    beyond = np.broadcast_to(indentation > most * (1.0 + ROUNDING), np.shape(indentation))
    if beyond.any():
        limit = float(np.broadcast_to(most, beyond.shape)[beyond].min())
        raise InvalidInput(
            f"an asperity is indented by more than {limit:.4g} mm, up to which {law} describes contacts; "
            "use lighter loads or a law with a larger range"
        )


@lru_cache(maxsize=64)
def _kept(keys: tuple[tuple[Any, float], ...]) -> FloatArray:
    """Return an array with one table in each row, padded with zeros to the longest."""
    found = [_one(*key) for key in keys]
    size = max(map(len, found))
    return np.stack([np.pad(row, (0, size - len(row))) for row in found])


def _one(law: Contact, radius: float) -> FloatArray:
    """Return the table of a law for one radius [mm]; it takes milliseconds to compute and about 100 kB."""
    end = float(law.largest_indentation(radius))
    # laws without an end are powers above 4 R
    last = end if math.isfinite(end) else 4.0 * radius
    # products of powers up to 32 do not underflow from 1e-60 on; below a/R = 1e-9 smooth laws are powers
    ends = law.contact_radius(np.array([1e-60 * radius, last]), radius)
    ends[0] = max(ends[0], 1e-9 * radius)
    breaks = law.breaks(radius)
    inside = breaks[(breaks > ends[0] * (1.0 + SAME)) & (breaks < ends[1] * (1.0 - SAME))]
    edge = np.log(law.indentation(np.concatenate([ends[:1], inside, ends[1:]]), radius) / radius)
    edge[-1] = math.log(last / radius)
    if len(edge) == 2:  # near the end of a cap its functions vary fast, at small indentations they are powers
        edge = np.insert(edge, 1, edge[-1] - 4.0)

    def functions(x: FloatArray) -> FloatArray:
        """Return ln p, ln a^2 and ln M (n, functions) at ln z, all over the radius."""
        found = law.contacts(radius * np.exp(x), np.array(radius))
        parts = [found.load / radius**2, found.area / (math.pi * radius**2)]
        if law.largest_order > 1:
            parts.append(law.second_moment(found.contact_radius, radius) / radius**4)
        return np.log(np.stack(parts, axis=-1))

    points = [_resolved(functions, *ends) for ends in pairwise(edge)]
    first = np.cumsum([0] + [len(x) - 1 for x, _ in points])
    columns = np.concatenate([_panels(x, y) for x, y in points])
    work = _energy(np.concatenate([x[:-1] for x, _ in points] + [edge[-1:]]), columns[..., 0])
    parts = zip(points, first[:-1], strict=True)
    energy = np.concatenate([_panels(x, work[k : k + len(x), None]) for (x, _), k in parts])
    columns = np.concatenate([columns[..., :2], energy, columns[..., 2:]], axis=2)
    panels = np.zeros((len(columns), kernel.PANEL))
    panels[:, : kernel.COEFFICIENTS * columns.shape[2]] = columns.transpose(0, 2, 1).reshape(len(columns), -1)
    before = kernel.HEADER + 4 * len(points)
    segments = [
        (x[0], (x[-1] - x[0]) / (len(x) - 1), len(x) - 1, before + kernel.PANEL * k)
        for (x, _), k in zip(points, first[:-1], strict=True)
    ]
    straight = not math.isfinite(end) and np.abs(columns[-1, 2:]).max() < RESOLVED
    most = math.inf if straight else last / radius
    table = np.concatenate([[most, 0.0, 0.0, 0.0, len(points)], np.ravel(segments), panels.ravel()])
    if law.largest_order > 1:
        table[1:4] = _flat(law, radius, ends, table)
    return table


def _flat(law: Contact, radius: float, ends: FloatArray, table: FloatArray) -> tuple[float, float, float]:
    """Return the load up to which T(p) is proportional to p, its slope there, and its offset above.

    T follows the law where D' > 0.005. Otherwise the tilt of a flat summit would grow without limit as its
    load vanishes. The slopes of the neighbours' fields reach this value when the contact radius is a fifth of
    the distance between contacts.
    """

    def excess(y: float) -> float:
        return float(law.profile_slope(math.exp(y), radius)) - 0.005  # increases with the contact radius

    low, high = np.log(ends)
    if excess(low) >= 0.0:
        return 0.0, 0.0, 0.0
    a = math.exp(high if excess(high) < 0.0 else brentq(excess, low, high))
    z = float(law.indentation(a, radius)) / radius
    load, _, _, _, lever, rate, _ = kernel.tilted(table[None], 0, 1.0, z)
    return load, 0.5 * rate, 0.5 * (rate * load - lever)


def _panels(x: FloatArray, y: FloatArray) -> FloatArray:
    """Return the coefficients (panels, COEFFICIENTS, ...) of a quintic spline between points x."""
    spline = make_interp_spline(x, y, k=kernel.COEFFICIENTS - 1)
    parts = [spline(x[:-1], k) / math.factorial(k) for k in range(kernel.COEFFICIENTS)]
    return np.stack(parts, axis=1)


def _resolved(
    functions: Callable[[FloatArray], FloatArray], low: float, high: float
) -> tuple[FloatArray, FloatArray]:
    """Return points x and the values of functions there, between which quintic splines resolve them."""
    x = np.linspace(low, high, max(math.ceil(high - low), kernel.COEFFICIENTS) + 1)
    y = functions(x)
    for _ in range(6):
        middle = 0.5 * (x[:-1] + x[1:])
        between = functions(middle)
        if np.abs(make_interp_spline(x, y, k=kernel.COEFFICIENTS - 1)(middle) - between).max() < RESOLVED:
            break
        places = np.arange(1, len(x))
        x, y = np.insert(x, places, middle), np.insert(y, places, between, axis=0)
    return x, y


def _energy(x: FloatArray, load: FloatArray) -> FloatArray:
    """Return ``ln int_0^z z dp = ln(z p - int_0^z p dz)`` at x = ln z, from the panels of ln p between."""
    node, weight = np.polynomial.legendre.leggauss(8)
    half, spline = 0.5 * np.diff(x)[:, None], PPoly(load.T[::-1], x)
    inside = x[:-1, None] + half * (node + 1.0)
    steps = (np.exp(spline(inside) + inside) * half) @ weight
    whole = np.exp(spline(x) + x)
    below = whole[0] / (1.0 + spline(x[0], 1))  # of a power
    return np.asarray(np.log(whole - below - np.concatenate([[0.0], np.cumsum(steps)])))
