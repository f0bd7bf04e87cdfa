"""Compliance of the pedestal of a spherical cap by finite elements."""

from __future__ import annotations

import math

import numpy as np

from metafem import _validate as check
from metafem.caps.shapes import sphere_profile
from metafem.contact import Hertz
from metafem.errors import refuse_if
from metafem.fe.elements import Body
from metafem.fe.geometry import Cap, graded_mesh
from metafem.fe.prescribed_radius import pressed

# Thickness and radius of the block below a pedestal, in summit radii; and how much less compliant this block
# is than a half-space, in units of 1/(pi PEDESTAL_EXTENT), computed without a cap (tests/fe/test_press.py).
PEDESTAL_EXTENT, SHORTFALL = 1e3, 1.366

# Degree, and size of the elements at the edge. The compliance of a pedestal is a small difference of two
# indentations, so the mesh is finer at the edge than in `press`. With degree 6, the compliance changes by
# 3e-5.
PEDESTAL_DEGREE, PEDESTAL_EDGE = 5, 1e-6


def measure_pedestal(height_ratio: float, contact_ratio: float, poisson_ratio: float = 0.5) -> float:
    """Return the compliance c_p R [-] that a spherical cap adds to a Hertz contact on a half-space.

    ``c_p = (d - d_Hertz(P)) pi E*/P`` follows from the extra indentation at the same load. In units of
    1/(pi R), c_p R is the diagonal of the influence matrix of asperities with Hertz contacts. Small
    strain is assumed.

    Parameters
    ----------
    height_ratio : float
        h/R [-], up to 1.
    contact_ratio : float
        a/R [-], within the cap.
    poisson_ratio : float
        nu [-], from 0 to 0.5; default: 0.5.

    Returns
    -------
    float
        c_p R [-].

    Raises
    ------
    InvalidInput
        If the contact exceeds the cap, or a value is outside its range.

    Examples
    --------
    >>> round(measure_pedestal(0.38, 0.1), 2)
    0.24
    """
    height = check.number("height_ratio", height_ratio, above=0.0, at_most=1.0)
    a = check.number("contact_ratio", contact_ratio, above=0.0)
    nu = check.number("poisson_ratio", poisson_ratio, **check.POISSON)
    cap = Cap(1.0, height, PEDESTAL_EXTENT, PEDESTAL_EXTENT)
    refuse_if(a >= cap.foot, f"contact_ratio = {a:g} must lie within the cap's edge at {cap.foot:g}")
    edge = float(cap.surface(np.array(a))[0])
    mesh = graded_mesh(edge, PEDESTAL_EXTENT, PEDESTAL_EXTENT, cap.foot, contact_edge=PEDESTAL_EDGE)
    body = Body(mesh, cap, PEDESTAL_DEGREE, nu)
    contact = pressed(body, lambda r: sphere_profile(r, 1.0), a, PEDESTAL_EXTENT)
    hertz = float(Hertz().indentation_at_load(contact.rescaled_load, 1.0))
    return float(
        math.pi * (contact.indentation - hertz) / contact.rescaled_load + SHORTFALL / PEDESTAL_EXTENT
    )
