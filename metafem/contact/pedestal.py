"""Compliance that a spherical cap adds to the half-space below it."""

from __future__ import annotations

import math

import numpy as np
from numpy.polynomial import polynomial
from numpy.typing import ArrayLike

from metafem._validate import FloatArray
from metafem.caps.shapes import foot_radius
from metafem.errors import refuse_if

# Largest h/R of the fit.
TALLEST = 0.6

# c_p R = sum over i, j of COEFFICIENTS[i, j] theta^i x^j, where theta is the slope angle of the sphere at the
# foot and x = a/R. The sum is fitted to finite elements with nu = 0.5, which stand in
# validation/finite_elements/pedestal.py; its relative error is at most FIT_ERROR.
COEFFICIENTS = np.array(
    [
        (0.0, 0.27508, -0.072683, 0.041567),
        (0.0, 0.000324, -0.085914, 0.0),
        (0.185815, -0.003441, 0.0, 0.0),
        (0.097759, 0.0, 0.0, 0.0),
        (-0.01401, 0.0, 0.0, 0.0),
        (0.007099, 0.0, 0.0, 0.0),
    ]
)
FIT_ERROR = 3e-4

# Terms of the fit that do not depend on the contact radius. The terms that grow with it belong to the contact
# law, as those of a sphere on a half-space do, and are left out: at large strain pi R (d - d_Hertz) E*/P of a
# cap 0.2 mm high falls instead, from 0.33 at a/R = 0.12 to 0.23 at 0.5 (meshes/soft_cap.csv).
LIGHT = COEFFICIENTS[:, 0]


def pedestal_compliance(height: ArrayLike, radius: ArrayLike, contact_radius: ArrayLike = 0.0) -> FloatArray:
    """Return the compliance c_p [1/mm] that a spherical cap adds to the half-space below it.

    ``d = d_Hertz(P) + c_p P/(pi E*)``, so c_p/pi is added to the diagonal of the influence matrix of the
    asperities. The formula is fitted to small-strain finite elements of an incompressible cap. At nu = 0.49
    and a/R = 0.1, c_p is 7 % smaller. c_p increases with the contact radius by about 0.25 a/R^2.

    Parameters
    ----------
    height, radius : array_like
        h and R of the cap [mm], 0.05 <= h/R <= 0.6.
    contact_radius : array_like
        a [mm], up to 0.6 times the foot radius of the cap; default: 0, the limit of light loads.

    Returns
    -------
    ndarray
        c_p [1/mm].

    Raises
    ------
    InvalidInput
        If h/R or a is outside the range of the fit.

    Examples
    --------
    >>> pedestal_compliance(0.2, 0.526, contact_radius=0.05).round(2)
    np.float64(0.46)
    """
    size = np.asarray(radius, dtype=np.float64)
    ratio = np.asarray(height, dtype=np.float64) / size
    refuse_if(
        not ((ratio >= 0.05) & (ratio <= TALLEST)).all(),
        f"height/radius must lie from 0.05 to {TALLEST:g}, the range of the fit",
    )
    x = np.asarray(contact_radius, dtype=np.float64) / size
    refuse_if(
        not ((x >= 0.0) & (x <= 0.6 * foot_radius(ratio, 1.0))).all(),
        "contact_radius must lie from 0 to 0.6 of the radius of the cap's foot",
    )
    angle = np.arccos(1.0 - ratio)
    terms = polynomial.polyval(angle, COEFFICIENTS)
    return np.asarray(polynomial.polyval(x, terms, tensor=False) / size)


def pedestal_influence(height: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return c_p/pi [1/mm] of each cap at light loads, and its derivative by the height [1/mm^2].

    c_p/pi is the displacement of a summit per unit of P/E* due to its own cap; see
    `metafem.contact.pedestal_compliance`. As h tends to 0, c_p vanishes in proportion to h, so the fit also
    applies below h/R = 0.05. Summits at or below the base plane have no pedestal. Above h/R = 0.6, c_p has
    its value at 0.6.

    Examples
    --------
    >>> value, rate = pedestal_influence(np.array([0.12, 0.27]), np.array([0.526, 0.526]))
    >>> (math.pi * value).round(2)
    array([0.22, 0.61])
    """
    ratio = np.clip(height / radius, 0.0, TALLEST)
    angle = np.arccos(1.0 - ratio)
    value = polynomial.polyval(angle, LIGHT) / (math.pi * radius)
    # d angle/dh = 1/(R sin(angle)); the ratio angle/sin(angle) stays finite as the angle tends to 0
    slope = polynomial.polyval(angle, polynomial.polyder(LIGHT)[1:]) / np.sinc(angle / math.pi)
    within = (ratio > 0.0) & (ratio < TALLEST)
    return np.asarray(value), np.where(within, slope / (math.pi * radius**2), 0.0)
