"""Rigid, frictionless plane pressed on one body until the contact has a given radius."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem.caps.shapes import sphere_profile
from metafem.contact import Hertz
from metafem.errors import InvalidInput, NotConverged, refuse_if
from metafem.fe.axisymmetric.geometry import Cap, Flat, Oblate, checked_cap
from metafem.fe.axisymmetric.mesh import graded_mesh, half_space_mesh
from metafem.fe.axisymmetric.prescribed_radius import PressedContact, Profile, graded, spectral
from metafem.fe.linear_solve import LinearStatus

# Radius at which the mesh of an unbounded layer ends, in thicknesses. The field decays as exp(-0.739 r/t) for
# nu = 0.5 (0.739 is the root of cos y = y) and faster for smaller nu, so the end changes the field at the
# contact by less than 1e-7.
LAYER_EXTENT = 12.0

# Degree of the returned solution, and degree of the second solution for the error estimate.
HALF_SPACE_DEGREES = (12, 10)
GRADED_DEGREES = (6, 5)

# Thickness and radius of the block below a pedestal, in summit radii; and how much less compliant this block
# is than a half-space, in units of 1/(pi PEDESTAL_EXTENT), computed without a cap (test_press.py).
PEDESTAL_EXTENT, SHORTFALL = 1e3, 1.366

# Degree, and size of the elements at the edge. The compliance of a pedestal is a small difference of two
# indentations, so the mesh is finer at the edge than in `press`. With degree 6, the compliance changes by
# 3e-5.
PEDESTAL_DEGREE, PEDESTAL_EDGE = 5, 1e-6


def press(
    contact_radius: float,
    radius: float | None = None,
    poisson_ratio: float = 0.5,
    *,
    height: float | None = None,
    thickness: float | None = None,
    block_radius: float | None = None,
    cell_radius: float | None = None,
    profile: Profile | None = None,
) -> PressedContact:
    """Return the contact between a rigid, frictionless plane and a body, with radius `contact_radius`.

    The problem is axisymmetric with small strain and E* = 1. Two linear problems with the same matrix are
    solved: a unit displacement of the contact, and the profile pressed flat. The indentation is that for
    which the combined pressure is finite at the edge of the contact. The body is one of:

    - a half-space with a paraboloid of `radius`, or with any `profile`: high-order elements in
      oblate-spheroidal coordinates;
    - a layer of given `thickness`, bonded to a rigid base. It has a free side at `block_radius`, or a side
      without radial displacement and shear at `cell_radius` (one cell of an infinite lattice), or no side;
    - a spherical cap of given `height` on this layer or block.

    For the last two, the mesh is graded towards the edge, and two criteria bracket the indentation: no
    reaction at the edge, and no gap at the next node. Half-space: Hertz (1882), doi:10.1515/crll.1882.92.156.

    Parameters
    ----------
    contact_radius : float
        a [mm].
    radius : float, optional
        R of the summit [mm]; required unless there is a `profile`.
    poisson_ratio : float
        nu [-], from 0 to 0.5; default: 0.5.
    height, thickness : float, optional
        Height of the cap, up to R, and thickness of the block below it [mm].
    block_radius, cell_radius : float, optional
        Radius of the side [mm]; default: neither, an unbounded layer.
    profile : callable, optional
        Depth f(r) [mm] below the summit at the radii r [mm], which replaces r^2/(2 R). f is vectorised and
        smooth, and f(0) = 0.

    Returns
    -------
    PressedContact

    Raises
    ------
    InvalidInput
        If a size does not fit the others, nu is outside [0, 0.5], or the contact carries no load.
    NotConverged
        If the residual of the linear system is large even with full pivoting.

    Notes
    -----
    Small strain overestimates P(a) of a soft sphere at large a/R. Relative to Hertz's law, P is 1.11 at
    a/R = 0.5, whereas finite strain gives 0.974 at a/R = 0.43. Hertz's law with a fitted modulus is then more
    accurate than small strain.

    Examples
    --------
    >>> contact = press(contact_radius=0.2, radius=0.526, poisson_ratio=0.5)
    >>> round(contact.rescaled_load, 8), round(4 / 3 * 0.2**3 / 0.526, 8)
    (0.02027883, 0.02027883)
    """
    a = check.number("contact_radius", contact_radius, above=0.0)
    nu = check.number("poisson_ratio", poisson_ratio, **check.POISSON)
    shape = _profile(radius, height, profile)
    if thickness is None:
        for name, size in (("height", height), ("block_radius", block_radius), ("cell_radius", cell_radius)):
            if size is not None:
                raise InvalidInput(f"{name} needs a thickness: a half-space has no sides")
        mesh, geometry, extent = half_space_mesh(), Oblate(a), a * math.cosh(20.0)
        pair = [spectral(mesh, geometry, degree, nu, shape, extent) for degree in HALF_SPACE_DEGREES]
    else:
        body, side = _body(a, radius, height, thickness, block_radius, cell_radius)
        foot = body.foot if isinstance(body, Cap) else None
        edge, extent = (float(body.surface(np.array(r))[0]) for r in (a, side))
        mesh, walled = graded_mesh(edge, extent, thickness, foot), cell_radius is not None
        pair = [graded(mesh, body, degree, nu, shape, a, extent, walled) for degree in GRADED_DEGREES]
    return _result(*pair)


def _result(fine: PressedContact, coarse: PressedContact) -> PressedContact:
    """Return the finer solution; its error estimate includes the coarser solution and the bracket."""
    refuse_if(
        not (fine.rescaled_load > 0.0 and fine.indentation > 0.0),
        "the profile carries no load: it must fall away from the axis",
    )
    change = max(
        abs(coarse.rescaled_load / fine.rescaled_load - 1.0), abs(coarse.indentation / fine.indentation - 1.0)
    )
    contact = replace(fine, error_estimate=change + fine.error_estimate + fine.residual)
    if fine.status is LinearStatus.NOT_CONVERGED:
        raise NotConverged(f"the linear system keeps a residual of {fine.residual:.1e}", contact)
    return contact


def _profile(radius: Any, height: Any, profile: Profile | None) -> Profile:
    """Return f(r): `profile`, the sphere of a cap, or the paraboloid on a flat body."""
    if profile is not None:
        refuse_if(
            radius is not None or height is not None,
            "profile replaces radius and height; give one or the other",
        )
        return profile
    refuse_if(radius is None, "radius is missing: give it, or a profile")
    big = check.number("radius", radius, above=0.0)
    if height is None:
        return lambda r: r**2 / (2.0 * big)
    return lambda r: sphere_profile(r, big)


def _body(
    a: float, radius: Any, height: Any, thickness: Any, block_radius: Any, cell_radius: Any
) -> tuple[Cap | Flat, float]:
    """Return the body and the radius of its side [mm], after a check of the dimensions."""
    t = check.number("thickness", thickness, above=0.0)
    refuse_if(
        block_radius is not None and cell_radius is not None,
        "block_radius and cell_radius exclude each other: a body has one side",
    )
    name = "block_radius" if cell_radius is None else "cell_radius"
    stated = block_radius if cell_radius is None else cell_radius
    side = check.number(name, LAYER_EXTENT * t if stated is None else stated, above=0.0)
    refuse_if(a >= side, f"contact_radius = {a:g} must be smaller than {name} = {side:g}")
    return Flat() if height is None else checked_cap(a, radius, height, t, name, side), side


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
    pressed = graded(
        mesh, cap, PEDESTAL_DEGREE, nu, lambda r: sphere_profile(r, 1.0), a, PEDESTAL_EXTENT, False
    )
    hertz = float(Hertz().indentation_at_load(pressed.rescaled_load, 1.0))
    return float(
        math.pi * (pressed.indentation - hertz) / pressed.rescaled_load + SHORTFALL / PEDESTAL_EXTENT
    )
