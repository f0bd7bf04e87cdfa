"""Rigid, frictionless plane pressed on one body until the contact has a given radius."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.caps.shapes import sphere_profile
from metafem.errors import refuse_if
from metafem.fe.elements import Body, solve
from metafem.fe.geometry import Cap, Flat, Oblate, checked_cap, graded_mesh, half_space_mesh

Profile = Callable[[FloatArray], FloatArray]

# Degree and size of the elements at the edge, over the contact radius, of the returned solution and of a
# second solution for the error estimate. The error of the indentation is proportional to the size.
HALF_SPACE = ((12, 1e-7), (10, 1e-6))
GRADED = ((6, 1e-6), (5, 3e-5))


@dataclass(frozen=True, eq=False)
class PressedContact:
    """Finite-element solution of one contact under a rigid, frictionless plane.

    Attributes
    ----------
    contact_radius : float
        a [mm].
    rescaled_load : float
        P/E* [mm^2].
    indentation : float
        Approach of the plane to the far body since first touch [mm].
    error_estimate : float
        Upper bound of the relative errors of load and indentation [-].
    residual : float
        Scaled residual of the linear system, recomputed [-].

    Examples
    --------
    >>> import metafem as mf
    >>> contact = mf.fe.press(contact_radius=0.2, radius=0.526)
    >>> round(contact.indentation, 6), round(contact.rescaled_load, 6)
    (0.076046, 0.020279)
    >>> contact.pressure([0.0, 0.1, 0.3]).round(4)
    array([0.2421, 0.2096, 0.    ])
    """

    contact_radius: float
    rescaled_load: float
    indentation: float
    error_estimate: float
    residual: float
    body: Body = field(repr=False)
    skeleton: FloatArray = field(repr=False)
    extent: float = field(repr=False)  # largest radius of the body [mm]

    def displacement(self, r: ArrayLike) -> FloatArray:
        """Return the downward displacement [mm] of the surface at the undeformed radii r [mm], of any shape.

        Raises
        ------
        InvalidInput
            If a radius is negative or outside the body.
        """
        radius = check.array("r", np.atleast_1d(r), shape=(None,))
        refuse_if(
            radius.min() < 0.0 or radius.max() > self.extent,
            f"r must lie from 0 to {self.extent:g}, the radius of the body",
        )
        result, closed = np.empty(radius.shape), radius <= self.contact_radius
        for name, part in (("contact", closed), ("free", ~closed)):
            place = self.body.located(name, self.body.geometry.surface(radius[part]))
            result[part] = self.body.fields_at(self.skeleton, *place)[0][1]
        return result.reshape(np.shape(r))

    def pressure(self, r: ArrayLike) -> FloatArray:
        """Return the contact pressure per horizontal area over E* [-] at the radii r [mm]; 0 outside."""
        radius = check.array("r", np.atleast_1d(r), shape=(None,))
        result = np.zeros(radius.shape)
        inside = np.abs(radius) < self.contact_radius
        # The hoop strain u/r needs r > 0; the lower bound 1e-6 a changes the result by a relative 1e-12.
        near = np.maximum(np.abs(radius[inside]), 1e-6 * self.contact_radius)
        body = self.body
        plane = body.geometry.surface(near)
        displacement, gradient, pressure = body.fields_at(self.skeleton, *body.located("contact", plane))
        mean = (gradient[0, 0] + gradient[1, 1] + displacement[0] / near) / 3.0
        down = 2.0 * body.shear_modulus * (gradient[1, 1] - mean) - pressure
        across = body.shear_modulus * (gradient[0, 1] + gradient[1, 0])
        # -(sigma_zz + sigma_rz n_r/n_z), where the boundary runs along the first plane coordinate
        tangent = body.geometry.jacobian(plane)[:, 0]
        result[inside] = across * tangent[1] / tangent[0] - down
        return result.reshape(np.shape(r))


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
    which the combined pressure is finite at the edge of the contact: the plane exerts no force there. The
    body is one of:

    - a half-space with a paraboloid of `radius`, or with any `profile`: high-order elements in
      oblate-spheroidal coordinates;
    - a layer of given `thickness`, bonded to a rigid base. It has a free side at `block_radius`, or a side
      without radial displacement and shear at `cell_radius` (one cell of an infinite lattice), or no side;
    - a spherical cap of given `height` on this layer or block.

    For the last two, the mesh is graded towards the edge. Half-space: Hertz (1882),
    doi:10.1515/crll.1882.92.156.

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
            refuse_if(size is not None, f"{name} needs a thickness: a half-space has no sides")
        side = a * math.cosh(20.0)
        bodies = [Body(half_space_mesh(size), Oblate(a), degree, nu) for degree, size in HALF_SPACE]
    else:
        flat, side = _body(a, radius, height, thickness, block_radius, cell_radius)
        edge, foot = float(flat.surface(np.array(a))[0]), flat.foot if isinstance(flat, Cap) else None
        meshes = [graded_mesh(edge, side, thickness, foot, contact_edge=size) for _, size in GRADED]
        bodies = [Body(mesh, flat, degree, nu) for mesh, (degree, _) in zip(meshes, GRADED, strict=True)]
    fine, coarse = (pressed(each, shape, a, side, walled=cell_radius is not None) for each in bodies)
    one, two = ((each.rescaled_load, each.indentation) for each in (fine, coarse))
    refuse_if(not min(one) > 0.0, "the profile carries no load: it must fall away from the axis")
    change = float(np.abs(np.divide(two, one) - 1.0).max())
    return replace(fine, error_estimate=change + fine.residual)


def pressed(
    body: Body, profile: Profile, contact_radius: float, extent: float, *, walled: bool = False
) -> PressedContact:
    """Return the contact on one mesh, without an error estimate.

    The indentation is that for which the plane exerts no force on the node at the edge.
    """
    start = body.displacement.skeleton
    down = slice(start, 2 * start)
    sides = ("axis", "base", "wall") if walled else ("axis", "base")
    fixed = np.concatenate([body.boundary(*sides), start + body.boundary("base", "contact")])
    value = np.zeros((body.matrix.shape[0], 2))
    value[down] = np.transpose([body.contact_values(part) for part in (np.ones_like, lambda r: -profile(r))])
    skeleton, residual = solve(body.matrix, fixed, value)
    force = 2.0 * math.pi * (body.matrix[down] @ skeleton)
    contact = body.nodes("contact")
    (edge,) = np.intersect1d(contact, body.nodes("free"))
    indentation = -float(force[edge, 1] / force[edge, 0])
    weight = np.array([indentation, 1.0])
    load = float(force[contact].sum(axis=0) @ weight)
    return PressedContact(
        contact_radius, load, indentation, math.nan, residual, body, skeleton @ weight, extent
    )


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
) -> tuple[Flat, float]:
    """Return the body and the radius of its side [mm], after a check of the dimensions."""
    t = check.number("thickness", thickness, above=0.0)
    refuse_if(
        block_radius is not None and cell_radius is not None,
        "block_radius and cell_radius exclude each other: a body has one side",
    )
    name, stated = ("block_radius", block_radius) if cell_radius is None else ("cell_radius", cell_radius)
    # the mesh of an unbounded layer ends at 12 t: the field decays at least as exp(-0.739 r/t), the rate for
    # nu = 0.5 (0.739 = cos 0.739), so the end changes the field at the contact by less than 1e-7
    side = check.number(name, 12.0 * t if stated is None else stated, above=0.0)
    refuse_if(a >= side, f"contact_radius = {a:g} must be smaller than {name} = {side:g}")
    return Flat() if height is None else checked_cap(a, radius, height, t, name, side), side
