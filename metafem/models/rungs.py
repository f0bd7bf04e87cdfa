"""Errors of independent asperities and of order 3, each estimated from the solution of that model.

The loads p of independent contacts displace the summits by ``u = G p``. At fixed total load, the indentations
therefore change by ``U - u_i``, where ``U = sum k_i u_i / sum k_i`` is the sinking of the base and k are the
stiffnesses of the contacts. The contact law then gives new loads, and a second step of this kind follows. The
two steps include second-order terms, and contacts that open or close.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import sizes_of
from metafem.models.curve import Curve, ModelError
from metafem.models.interacting.influence import displacements, nearest_distance
from metafem.models.load_equation import LoadEquation
from metafem.models.truncation import equivalent_radii, nearest, slope_effects, truncation
from metafem.substrate import Substrate
from metafem.surface import Surface

# Sources of the estimates.
DISPLACEMENTS = "the displacements by the loads of independent contacts"
RADII = "the contact radii relative to the distances and the thickness"

# Number of contacts, summed over the loads, for which the error of independent asperities is estimated; and
# minimum number of these loads. A contact that closes between two of them changes A0 by a fraction of about
# the inverse of their number.
PROBED, FEWEST = 6400, 6

# If the relative error is smaller than this after one step, no second step is taken.
NEGLIGIBLE = 1e-4

# Safety factor of the estimates; a quarter is also added to the estimates of order 3. In 1500 random scenes
# the errors were up to 1.3 times the estimates without this factor.
SAFETY = 1.25

# Relative decrease of a contact area at fixed load, divided by the product of a small extra curvature and the
# summit radius.
FLATTENING = 2.0 / 3.0

# Largest sum of (r_min/r)^3 over the neighbours of a site at distances r, where r_min is the smallest
# distance of two sites: the sum for a hexagonal lattice.
PACKED = 11.04


def probed(load: FloatArray, count: int) -> IntArray:
    """Return the indices of the positive loads at which the error is estimated; the last load is included."""
    rows = np.flatnonzero(load > 0.0)
    some = max(FEWEST, PROBED // count)
    if rows.size <= some:
        return rows
    return rows[np.unique(np.rint(np.linspace(0, rows.size - 1, some)).astype(np.int64))]


def independent_error(
    equation: LoadEquation, surface: Surface, substrate: Substrate, curve: Curve, tolerance: float
) -> tuple[float, FloatArray]:
    """Return the largest relative error of A0 along a curve, and the sinking per load [1/mm] (k,).

    The last load, where the error is usually largest, is judged first; the others only if it is within the
    tolerance. substrate: with the thickness and the material of the surface.
    """
    rows = probed(curve.load, surface.count)
    displacement = displacements(surface, substrate)
    largest = float(curve.last.load.max())
    wide = _higher_orders(equation.law, surface, substrate, curve, largest)
    for some in dict.fromkeys(((rows.size - 1, rows.size), (0, rows.size))):
        judged = rows[slice(*some)]
        error, sinking = _steps(equation, surface, curve, judged, displacement)
        worst = SAFETY * float(error.max()) + wide
        if worst > tolerance:
            break
    return worst, np.interp(curve.load, curve.load[judged], sinking)


def _steps(
    equation: LoadEquation,
    surface: Surface,
    curve: Curve,
    rows: IntArray,
    displacement: Callable[[FloatArray], FloatArray],
) -> tuple[FloatArray, FloatArray]:
    """Return relative changes of A0 by interaction and sinkings per load [1/mm] at m rows, (m,) each."""
    radius, load, area = equation.law.summits(surface), curve.load[rows], curve.area[rows]
    z = curve.approach[rows, None] - surface.gap
    own, rate, _, _ = equation.rates(z, radius)

    def sinking(u: FloatArray) -> FloatArray:
        """Return the sinking of the base [mm], (m,), for displacements u (m, n)."""
        return np.asarray((rate * u).sum(axis=1) / rate.sum(axis=1))

    def step(u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the areas A0 (m,) and the loads of the contacts (m, n) after displacements u (m, n)."""
        shifted = z - u + sinking(u)[:, None]
        for _ in range(2):
            pressed, slope, areas, area_slope = equation.rates(shifted, radius)
            missing = ((load - pressed.sum(axis=1)) / slope.sum(axis=1))[:, None]
            shifted = shifted + missing
        return (areas + area_slope * missing).sum(axis=1), pressed + slope * missing

    u = displacement(own)
    first, pressed = step(u)
    error = np.abs(first - area)
    if (error > NEGLIGIBLE * area).any():
        second, _ = step(displacement(pressed))
        error = np.abs(second - area) + np.abs(second - first)
    return error / area, sinking(u) / load


def _higher_orders(law: Contact, surface: Surface, substrate: Substrate, curve: Curve, load: float) -> float:
    """Return the relative error of A0 due to the finite size of the contacts, at the last load of a curve.

    load: the largest load of one contact [mm^2]. If an upper bound is negligible, it is returned; the bound
    assumes the densest arrangement of sites with the same smallest distance.
    """
    own = abs(getattr(substrate, "self_curvature", 0.0))
    radius = float(sizes_of(law.summits(surface)).max())
    densest = PACKED / (2.0 * math.pi * nearest_distance(surface) ** 3)
    most = FLATTENING * (densest + own) * load * radius
    if law == PARABOLOID and most <= 0.1 * NEGLIGIBLE:
        return float(most)
    area = curve.last.area
    closed = np.flatnonzero(area > 0.0)
    load_of, position = curve.last.load[closed], surface.position[closed]
    curvature = own * load_of
    if closed.size > 1 or surface.cell is not None:
        r, near = nearest(position, surface.cell)
        curvature += (load_of[near] / (2.0 * math.pi * r**3)).sum(axis=1)
    response = equivalent_radii(law, surface, area)[0][closed]
    flatter = FLATTENING * float(curvature * response @ area[closed] / area.sum())
    tilted = 0.0 if law == PARABOLOID else slope_effects(law, surface, area, substrate)[0]
    return flatter + tilted + truncation(surface, area, substrate, law)


def order_3_error(surface: Surface, area: FloatArray, substrate: Substrate, law: Contact) -> ModelError:
    """Return the error of A0 by order 3 for areas (n,) [mm^2]; nan for laws that only order 1 can couple."""
    if law.largest_order == 1:
        return ModelError(math.nan, f"contacts of {law!r} cannot be resolved")
    error = truncation(surface, area, substrate, law)
    return ModelError(error, RADII) if math.isfinite(error) else ModelError(math.nan, "contacts overlap")
