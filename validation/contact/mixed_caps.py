"""Caps that differ from asperity to asperity, against closed forms of each and resolved contacts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache

import numpy as np

import metafem as mf
from metafem._validate import FloatArray
from validation.check import Claim, Row, below, near
from validation.methods.caps import Caps, areas
from validation.sources import second_method

# Resolved contacts of nine caps take some seconds.
SLOW = True

# Exponents and coefficients of the caps, in turn on the sites of the lattice; R and pitch [mm].
SHAPES = ((4.0, 0.5), (2.0, 0.5), (1.5, 0.3), (3.0, 0.6))
RADIUS, PITCH = 0.526, 1.2

# Loads [N] of nine asperities with E* = 1 MPa, up to contact radii of 0.27 of the pitch.
LOADS = np.array([0.01, 0.05, 0.3])

# Cells of the resolved contacts [mm], from which areas are extrapolated to vanishing cells.
CELLS = (0.01, 0.005)

# Approach [mm] at which loads are compared: the largest contact radius is 0.27 of the pitch.
APPROACH = 0.14

# Accuracy of bisection and Newton's method, with a margin, and the wanted errors of A0 and of the load.
METHODS, WANTED, WANTED_LOAD = 1e-12, 2e-3, 5e-4

BISECTION = second_method(areas, "sums of closed forms of each cap, by Newton's method for the approach")
RESOLVED = second_method(mf.BoundaryElements, "resolved contacts, extrapolated to vanishing cells")


@cache
def surface() -> mf.Surface:
    """Return nine caps of four shapes and random heights."""
    height = 0.1 - 0.01 * np.random.default_rng(1).random(9)
    caps = [mf.Power(*SHAPES[i % 4]) for i in range(9)]
    return mf.Surface.square_lattice(
        height, (3, 3), PITCH, radius=RADIUS, material=mf.Material(1.0), cap=caps
    )


@cache
def laws() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return A0 (k,) of independent asperities, of order 3 and of resolved contacts [mm²]."""
    alone = mf.friction_law(surface(), mf.Independent(contact=mf.Elastic()), load=LOADS).area
    order_3 = mf.friction_law(surface(), mf.Interacting(contact=mf.Elastic()), load=LOADS).area
    resolved = [mf.friction_law(surface(), model, load=LOADS).area for model in _resolved()]
    return alone, order_3, _extrapolated(*resolved)


def load_error() -> float:
    """Return the relative error of the load of order 3 at a given approach."""
    models = (mf.Interacting(contact=mf.Elastic()), *_resolved())
    found, coarse, fine = (mf.equilibrium(surface(), model, approach=APPROACH).load for model in models)
    return abs(found / _extrapolated(coarse, fine) - 1.0)


def _resolved() -> list[mf.BoundaryElements]:
    return [mf.BoundaryElements(cell, contact=mf.Elastic()) for cell in CELLS]


def _extrapolated(coarse, fine):
    """Return the value at vanishing cells, whose error is of second order."""
    return fine + (fine - coarse) / ((CELLS[0] / CELLS[1]) ** 2 - 1.0)


def claim() -> Claim:
    """Each asperity may have its own cap. The areas of independent asperities are the sums of the closed
    forms of their caps. With interaction, order 3 agrees with resolved contacts as it does for equal caps.
    """
    return Claim("Caps of different shapes on one surface", list(_rows()))


def _rows() -> Iterator[Row]:
    alone, order_3, resolved = laws()
    exponent, coefficient = np.array([SHAPES[i % 4] for i in range(9)]).T
    expected = areas(Caps(RADIUS, exponent, coefficient), surface().height, LOADS)
    for load, found, area in zip(LOADS, alone, expected, strict=True):
        yield near(f"independent caps: A0 at {load:g} N [mm²]", found, area, METHODS * area, BISECTION)
    error = np.abs(order_3 / resolved - 1.0)
    for load, each in zip(LOADS, error, strict=True):
        yield below(f"order 3: relative error of A0 at {load:g} N", each, WANTED, RESOLVED)
    name = f"order 3: relative error of the load at an approach of {APPROACH:g} mm"
    yield below(name, load_error(), WANTED_LOAD, RESOLVED)
