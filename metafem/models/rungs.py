"""Errors of independent asperities and of order 1, each estimated from its own solution.

At independent contacts with loads p, ``u = G p`` displaces the summits. With the stiffnesses k and at fixed
load, the indentations change by ``U - u_i`` with ``U = sum k_i u_i / sum k_i``, the sinking of the base. Two
steps of this kind, each with the law itself, include second-order terms and contacts that open or close. The
equations of order 3 at the solution of order 1 give the error of order 1 in the same way.
"""

from __future__ import annotations

import math
from typing import cast

import numpy as np
import scipy

from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.models.curve import Curve
from metafem.models.interacting.elastic import ElasticCoupling
from metafem.models.interacting.influence import displacements, nearest_distance
from metafem.models.interacting.model import Interacting
from metafem.models.load_equation import LoadEquation
from metafem.models.truncation import NEIGHBOURS, equivalent_radii, truncation
from metafem.substrate import Substrate
from metafem.surface import Surface

# Contacts, over all loads, of which the error of independent asperities is estimated; and the least number of
# loads. A contact that closes between two of them changes A0 by about the inverse of their number.
PROBED, FEWEST = 6400, 6

# Estimates up to this are those of one step.
NEGLIGIBLE = 1e-4

# A quarter is added to the estimates for safety, as to those of order 3: in 1500 random scenes the errors
# were up to 1.3 times the estimates without it.
SAFETY = 1.25

# Relative decrease of an area, at fixed load, per product of a small curvature and the summit radius.
FLATTENING = 2.0 / 3.0

# Largest sum of (distance of the nearest/distance)^3: that of a hexagonal lattice.
PACKED = 11.04


def probed(load: FloatArray, count: int) -> IntArray:
    """Return the rows of positive loads at which the error is estimated, the last among them."""
    rows = np.flatnonzero(load > 0.0)
    some = max(FEWEST, PROBED // count)
    if rows.size <= some:
        return rows
    return rows[np.unique(np.rint(np.linspace(0, rows.size - 1, some)).astype(np.int64))]


def independent_errors(
    equation: LoadEquation,
    surface: Surface,
    curve: Curve,
    rows: IntArray,
    substrate: Substrate,
) -> tuple[FloatArray, FloatArray]:
    """Return relative errors of A0 and the sinking per load [1/mm] at some rows of a curve, (m,) each.

    substrate: that of the surface.
    """
    displacement = displacements(surface, substrate)
    radius, load, area = surface.radius, curve.load[rows], curve.area[rows]
    z = curve.approach[rows, None] - surface.gap
    own, rate, _, _ = equation.rates(z, radius)

    def step(u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return areas at the loads and loads (m, n), after displacements (m, n)."""
        shifted = z - u + ((rate * u).sum(axis=1) / rate.sum(axis=1))[:, None]
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
    sinking = (rate * u).sum(axis=1) / rate.sum(axis=1)
    error = error / area
    wide = _higher_orders(equation.law, surface, substrate, curve, float(own.max()))
    return SAFETY * error + wide, sinking / load


def _higher_orders(law: Contact, surface: Surface, substrate: Substrate, curve: Curve, load: float) -> float:
    """Return the relative error of A0 by the size of the contacts, at the last load of a curve.

    load: the largest of a contact [mm^2]. First by the densest sites possible at the distance of the nearest.
    """
    own = abs(getattr(substrate, "self_curvature", 0.0))
    radius = float(surface.radius.max())
    densest = PACKED / (2.0 * math.pi * nearest_distance(surface) ** 3)
    most = FLATTENING * (densest + own) * load * radius
    if law == PARABOLOID and most <= 0.1 * NEGLIGIBLE:
        return float(most)
    area = curve.last.area
    closed = np.flatnonzero(area > 0.0)
    load_of, position = curve.last.load[closed], surface.position[closed]
    curvature = own * load_of
    if closed.size > 1:
        some = min(NEIGHBOURS + 1, closed.size)
        r, near = scipy.spatial.cKDTree(position).query(position, k=some)
        curvature += (load_of[near[:, 1:]] / (2.0 * math.pi * r[:, 1:] ** 3)).sum(axis=1)
    response = equivalent_radii(law, surface, area)[0][closed]
    flatter = FLATTENING * float(curvature * response @ area[closed] / area.sum())
    return flatter + truncation(surface, area, substrate, law)


def order_1_error(model: Interacting, surface: Surface, curve: Curve, indentation: FloatArray) -> float:
    """Return the largest relative error of A0 along a curve of order 1; `model` is that of order 3.

    indentation: (m, n) [mm], at the last m loads. It is estimated at some of them, and where a contact is
    closest to touching.
    """
    first = len(curve.load) - len(indentation)
    # without a paraboloid's constant dA/dd the area of a contact that closes may grow at any rate
    few = max(surface.count, PROBED // FEWEST) if model.contact == PARABOLOID else surface.count
    some = probed(curve.load[first:], few)
    touching = np.argsort(np.abs(indentation).min(axis=1))[:FEWEST]
    bound = cast("ElasticCoupling", model.bound(surface))
    worst = 0.0
    for row in sorted({*some.tolist(), *touching.tolist()}):
        load, area, x = (float(part[first + row]) for part in (curve.load, curve.area, curve.approach))
        if area > 0.0:
            worst = max(worst, abs(_area_of_order_3(bound, indentation[row], x, load) / area - 1.0))
    return SAFETY * worst


def _area_of_order_3(bound: ElasticCoupling, z: FloatArray, approach: float, load: float) -> float:
    """Return the area [mm^2] after one step from a solution of order 1; infinite where the law ends."""
    state, error = bound.response(z, approach)
    rate = np.where(state.z > 0.0, state.rate / state.bend, 0.0)
    state, _ = bound.response(z - (error - rate @ error / rate.sum()) / state.bend, approach)
    closed = state.z > 0.0
    if not closed.any() or state.outside[closed].any():
        return math.inf
    rate = state.rate[closed] / state.bend[closed]
    missing = (load - float(state.load[closed].sum())) / float(rate.sum())
    return math.pi * float((state.square[closed] + state.widening[closed] * rate * missing).sum())
