"""Sensitivity of A0 to the shape of each cap for interacting asperities without adhesion.

A parameter s of the cap of asperity i enters the energy W of `_kernels.coupling` through its complementary
energy w and its moment T alone. At an equilibrium dW/dp = 0, so that a change ds acts on the loads as changes
of the heights by minus the derivatives of dW/dp_j by s. With the sensitivities G_j = dA0/dh_j at fixed load,
the extra curvature k and the slope g of the neighbours' field, all derivatives by s at given p and k,

    dA0/ds = dA_i/ds - G_i (dd/ds - |g|^2 d2T/dp ds) - 1/4 dM/ds lap u_G + 2 dT/ds g . grad u_G,

where u_G is the displacement at asperity i by the loads G.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._kernels.contact.tabulated import LEVER_EDGE, LEVER_START, Law
from metafem._kernels.coupling import State
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.law import SMALL, ShapeRates
from metafem.models.contact_tables import FLATTEST
from metafem.surface import Surface

# Laplacian and slopes of a field at the asperities, (n,) each.
Field = tuple[FloatArray, FloatArray, FloatArray]


class Shapes(NamedTuple):
    """The contacts of a surface for unit E*, and the parameter of the caps."""

    surface: Surface
    law: Contact
    own: Contact  # the law before it was bound to the caps
    table: Law
    by: str

    def rates(self, contact_radius: FloatArray, by: str | None = None) -> ShapeRates:
        """Return the derivatives at contact radii (n,) > 0."""
        return self.own.shape_rates(by or self.by, contact_radius, self.surface)


def shape_gradient(shapes: Shapes, state: State, gradient: FloatArray, field: Field | None) -> FloatArray:
    """Return dA0/ds (n,) at an equilibrium with dA0/dh (n,); field: that of the loads dA0/dh, for order 3."""
    closed = state.z > 0.0
    a = np.where(closed, np.sqrt(state.square), SMALL * shapes.surface.radius)
    rates = shapes.rates(a)
    compliance = np.divide(state.bend, state.rate, out=np.zeros_like(a), where=closed)
    change = -gradient * (rates.indentation - rates.load * compliance)
    change -= math.pi * rates.load * state.by_load
    if field is not None:
        change += _order_3(shapes, state, a, rates, gradient, field)
    return np.where(closed, change, 0.0)


def _order_3(
    shapes: Shapes, state: State, a: FloatArray, rates: ShapeRates, gradient: FloatArray, field: Field
) -> FloatArray:
    """Return the terms of order 3: those of the moments M and T, and of the area of a contact on a slope."""
    laplacian, slope_x, slope_y = field
    moment = rates.moment - 2.0 / 3.0 * a**2 * rates.load
    lever, lever_rate = _lever(shapes, state)
    square = state.slope_x**2 + state.slope_y**2
    tilt = state.slope_x * slope_x + state.slope_y * slope_y
    change = gradient * lever_rate * square - 0.25 * moment * laplacian + 2.0 * lever * tilt
    return np.asarray(change + _on_slope(shapes, state, a, rates, square))


def _lever(shapes: Shapes, state: State) -> tuple[FloatArray, FloatArray]:
    """Return the derivatives by the parameter of T and of dT/dp at given loads, (n,).

    ``T = 2/3 a^3 + T0`` with the contact radius a without extra curvature; below the load p_e, at which D' is
    `FLATTEST`, T is proportional to the load.
    """
    surface, table = shapes.surface, shapes.table
    summits = shapes.law.summits(surface)
    a = np.where(state.z > 0.0, shapes.law.contact_radius(state.z, summits), SMALL * surface.radius)
    rates, slope = shapes.rates(a), shapes.law.profile_slope(a, summits)
    moment = -0.5 * rates.load * state.lever_rate
    by_load = -0.5 * rates.load * state.lever_bend - a * rates.slope / slope**2
    if not table.data.size:
        return moment, by_load
    edge_load = table.data[table.which, LEVER_EDGE] * table.scale**2
    start = table.data[table.which, LEVER_START] * table.scale
    edge = np.where(start > 0.0, FLATTEST * start, SMALL * surface.radius)
    at_edge = shapes.rates(edge)
    # D'' follows from the derivative of D' by R, because D' depends on a/R alone
    bend = -surface.radius / edge * shapes.rates(edge, "radius").slope
    start_rate = np.divide(-at_edge.slope, FLATTEST * bend, out=np.zeros_like(edge), where=bend > 0.0)
    moment += start_rate * edge_load + start * at_edge.load
    linear = state.load <= edge_load
    return np.where(linear, start_rate * state.load, moment), np.where(linear, start_rate, by_load)


def _on_slope(
    shapes: Shapes, state: State, a: FloatArray, rates: ShapeRates, square: FloatArray
) -> FloatArray:
    """Return the change of the areas pi a^2 F(y) through y at given a, (n,); see `contact.tabulated`."""
    extra = 0.5 * state.curvature
    slope = shapes.law.profile_slope(a, shapes.law.summits(shapes.surface), extra)
    wide = np.where(state.z > 0.0, state.square, 1.0)
    factor = np.where(state.z > 0.0, state.footprint, 1.0) / wide
    convex = factor < 1.0
    y = np.where(convex, (1.0 / factor**2 - 1.0) / 4.0, 0.5 * (1.0 - factor))
    rate = np.where(convex, -2.0 * factor**3, -2.0)
    y_rate = (a * rates.bend - rates.slope) * square / slope**3 - 3.0 * y * rates.slope / slope
    return np.asarray(math.pi * wide * rate * y_rate)
