"""Compliance that a cap adds to the half-space on which it stands."""

from __future__ import annotations

import math

import numpy as np

from metafem import _validate as check
from metafem.contact import Hertz
from metafem.contact.cap_geometry import sphere_profile
from metafem.errors import refuse_if
from metafem.fe.axisymmetric.geometry import Cap
from metafem.fe.axisymmetric.mesh import graded_mesh
from metafem.fe.axisymmetric.prescribed_radius import graded

# Thickness and radius of the block, in summit radii; and the deficit of its compliance from that of a
# half-space, in units of 1/(pi EXTENT), computed without a cap (test_cap_compliance.py).
EXTENT, SHORTFALL = 1e3, 1.366

# The compliance is a small difference of indentations, so the mesh is finer at the edge than in `press`. One
# degree more changes the compliance by 3e-5 of its value.
DEGREE, EDGE = 5, 1e-6


def measure_pedestal(height_ratio: float, contact_ratio: float, poisson_ratio: float = 0.5) -> float:
    """Extra indentation of a spherical cap on a half-space over Hertz's at the same load, as a compliance.

    ``c_p R`` with ``c_p = (d - d_Hertz(P)) pi E*/P``. With Hertz contacts it is the diagonal of the
    influence between asperities in units of 1/(pi R). Small strain.

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
        If the contact does not lie within the cap, or a value is outside its range.

    Examples
    --------
    >>> round(measure_pedestal(0.38, 0.1), 2)
    0.24
    """
    height = check.number("height_ratio", height_ratio, above=0.0, at_most=1.0)
    a = check.number("contact_ratio", contact_ratio, above=0.0)
    nu = check.number("poisson_ratio", poisson_ratio, **check.POISSON)
    cap = Cap(1.0, height, EXTENT, EXTENT)
    refuse_if(a >= cap.foot, f"contact_ratio = {a:g} must lie within the cap's edge at {cap.foot:g}")
    edge = float(cap.surface(np.array(a))[0])
    mesh = graded_mesh(edge, EXTENT, EXTENT, cap.foot, contact_edge=EDGE)
    pressed = graded(mesh, cap, DEGREE, nu, lambda r: sphere_profile(r, 1.0), a, EXTENT, False)
    hertz = float(Hertz().indentation_at_load(pressed.rescaled_load, 1.0))
    return float(math.pi * (pressed.indentation - hertz) / pressed.rescaled_load + SHORTFALL / EXTENT)
