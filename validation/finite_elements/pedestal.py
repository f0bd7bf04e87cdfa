"""Compliance of the pedestal of a spherical cap by finite elements."""

from __future__ import annotations

import math

import numpy as np

from metafem.caps.shapes import sphere_profile
from metafem.contact import Hertz
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


def measure_pedestal(height_ratio: float, a: float) -> float:
    """Return the compliance c_p R [-] that a cap of height h/R adds to a Hertz contact of radius a/R.

    ``c_p = (d - d_Hertz(P)) pi E*/P`` follows from the extra indentation at the same load. In units of
    1/(pi R), c_p R is the diagonal of the influence matrix of asperities with Hertz contacts. Small
    strain is assumed.
    """
    cap = Cap(1.0, height_ratio, PEDESTAL_EXTENT, PEDESTAL_EXTENT)
    edge = float(cap.surface(np.array(a))[0])
    mesh = graded_mesh(edge, PEDESTAL_EXTENT, PEDESTAL_EXTENT, cap.foot, contact_edge=PEDESTAL_EDGE)
    body = Body(mesh, cap, PEDESTAL_DEGREE, 0.5)
    contact = pressed(body, lambda r: sphere_profile(r, 1.0), a, PEDESTAL_EXTENT)
    hertz = float(Hertz().indentation_at_load(contact.rescaled_load, 1.0))
    return float(
        math.pi * (contact.indentation - hertz) / contact.rescaled_load + SHORTFALL / PEDESTAL_EXTENT
    )
