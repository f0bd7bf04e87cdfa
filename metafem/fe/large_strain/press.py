"""A spherical cap of incompressible rubber under a rigid plane at large strain, with slip or stick."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.contact import TabulatedContact
from metafem.contact.cap_geometry import sphere_profile
from metafem.errors import NotConverged, refuse_if
from metafem.fe.axisymmetric.geometry import Cap, checked_cap
from metafem.fe.axisymmetric.mesh import graded_mesh
from metafem.fe.large_strain.body import FiniteContact, SoftBody
from metafem.material import Material
from metafem.substrate import BondedLayer

# Size of the last elements at the edge, relative to the contact radius: the bracket of the edge is of this
# order, which is below the error of quadratic elements.
CONTACT_EDGE = 1e-4

# Size of the elements at the cap's foot, relative to its radius. The corner closes to a crease, which makes a
# fine mesh fold; coarse elements smooth it, without effect on the contact.
FOOT_EDGE = 0.05

# Refinements of the graded mesh: for the result, and for the coarser solution of the error estimate.
REFINEMENTS = (1, 0)

# Largest relative error of the deformed radius, and largest number of secant steps for the material radius.
# Each step gains three digits or more, as the two radii differ by a few percent.
RADIUS_ERROR, SECANT_STEPS = 1e-7, 12

# Number of increasing contacts with stick: at a/R = 0.5 half as many change the load by 1e-4, twice as many
# by 2e-6.
HISTORY = 4


def press_finite(
    contact_radius: float,
    radius: float,
    *,
    height: float,
    thickness: float,
    block_radius: float,
    stick: bool = False,
) -> FiniteContact:
    """Press a rigid plane on a soft spherical cap until the deformed contact radius is `contact_radius`.

    Large strain, axisymmetric, incompressible neo-Hookean: ``W = mu/2 (F:F - 3)`` with ``J = 1`` and
    E* = 4 mu, with quadratic displacements and linear pressures in the undeformed frame. The points up to a
    material radius are on the plane. The indentation is that at which no force acts on the last of them:
    the pressure is finite at the edge. The deformed value of the material radius is
    `contact_radius`. The body is the cap on a block bonded to a rigid base, with free sides, as in `press`.

    Points slip without friction or, with `stick`, remain where they first touched the plane:
    ``r = a(s)`` for the undeformed radius s, determined by a sequence of increasing contacts. In each of them
    no shear force acts on the last point.

    Parameters
    ----------
    contact_radius : float
        a [mm], below the radius of the cap's base.
    radius, height : float
        Radius of the sphere and height of its cap [mm], the height up to the radius.
    thickness, block_radius : float
        Thickness and radius of the block [mm].
    stick : bool
        Whether points in contact stick to the plane; default: False.

    Returns
    -------
    FiniteContact

    Raises
    ------
    InvalidInput
        If a size is not positive or does not fit the others.
    NotConverged
        If Newton's method or the search for the material radius fails; the last state is attached.

    Notes
    -----
    With h/R = 0.38, P(a) is 0.989 of Hertz's at a/R = 0.1, 0.974 at 0.4 and 0.978 at 0.5. At 0.5 small
    strain (`press`) gives 1.11: its error is larger than that of Hertz's law and has the opposite sign. For
    soft bodies at large a/R, Hertz's law with a fitted E* is more accurate than small strain.

    Examples
    --------
    >>> contact = press_finite(0.26, 0.526, height=0.2, thickness=7.2, block_radius=10.0)
    >>> round(contact.rescaled_load / (4 / 3 * 0.26**3 / 0.526), 3)
    0.977
    """
    a = check.number("contact_radius", contact_radius, above=0.0)
    check.instance("stick", stick, bool, "True or False")
    cap = checked_cap(a, radius, height, thickness, "block_radius", block_radius)
    radii = a * np.arange(1, HISTORY + 1) / HISTORY if stick else np.array([a])
    return press_sequence(radii, cap, stick)[-1]


def press_sequence(
    radii: FloatArray, cap: Cap, stick: bool, refinements: tuple[int, int] = REFINEMENTS
) -> list[FiniteContact]:
    """Return contacts of increasing radii; with stick each one depends on the previous ones."""
    coarse = _on_mesh(radii, cap, stick, refinements[1], [])
    fine = _on_mesh(radii, cap, stick, refinements[0], [c.material_radius for c in coarse])
    change = [_change(one, two) for one, two in zip(fine, coarse, strict=True)]
    if stick and len(radii) > 1:
        # every second contact, including the last one
        half = _on_mesh(radii[::-2][::-1], cap, stick, refinements[1], [])
        change[-1] += _change(half[-1], coarse[-1])
    return [
        replace(one, error_estimate=one.error_estimate + extra)
        for one, extra in zip(fine, change, strict=True)
    ]


def _change(one: FiniteContact, two: FiniteContact) -> float:
    return max(abs(one.rescaled_load / two.rescaled_load - 1.0), abs(one.indentation / two.indentation - 1.0))


def _on_mesh(
    radii: FloatArray, cap: Cap, stick: bool, refinement: int, guesses: list[float]
) -> list[FiniteContact]:
    """Return contacts of increasing radii on meshes of one refinement."""
    contacts: list[FiniteContact] = []
    for i, a in enumerate(radii):
        guess = guesses[i] if guesses else a * (contacts[-1].material_radius / radii[i - 1] if i else 1.0)
        contacts.append(_contact(float(a), cap, contacts if stick else None, refinement, float(guess)))
    return contacts


def stick_mode(s: FloatArray, earlier: list[FiniteContact], unit: float) -> FloatArray:
    """Return the term of the radial displacement that vanishes where earlier contacts ended.

    The displacement at first contact over the undeformed radius s is ``s^3`` times Newton's polynomial. There
    is no term of s^2, as an incompressible surface does not move radially at small strain.
    """
    factors = [(s - contact.material_radius) / unit for contact in earlier]
    return np.asarray(unit * (s / unit) ** 3 * np.prod([np.ones_like(s), *factors], axis=0))


def stuck_displacement(s: FloatArray, earlier: list[FiniteContact], unit: float) -> FloatArray:
    """Return the radial displacement of points that stick since earlier contacts."""
    terms = (contact.shift * stick_mode(s, earlier[:i], unit) for i, contact in enumerate(earlier))
    return sum(terms, start=np.zeros_like(s))


def _contact(
    a: float, cap: Cap, earlier: list[FiniteContact] | None, refinement: int, guess: float
) -> FiniteContact:
    """Return the contact with the deformed radius a; the material radius is found by the secant method.

    With stick, `earlier` holds the smaller contacts.
    """
    state: FiniteContact | None = None
    material, before = guess, (0.0, 0.0)
    for _ in range(SECANT_STEPS):
        refuse_if(
            not material < cap.foot,
            f"contact_radius = {a:g} brings the cap's edge at {cap.foot:g} into contact",
        )
        state = _flatten(material, cap, earlier, refinement, state)
        edge = state.contact_radius
        if abs(edge / a - 1.0) <= RADIUS_ERROR:
            return replace(state, contact_radius=a, material_radius=material)
        slope = (edge - before[1]) / (material - before[0])
        before, material = (material, edge), material + (a - edge) / slope
    raise NotConverged(f"no material radius found for the contact radius {a:g}", state)


def _flatten(
    material: float,
    cap: Cap,
    earlier: list[FiniteContact] | None,
    refinement: int,
    start: FiniteContact | None,
) -> FiniteContact:
    """Flatten the cap up to a material radius, from a state with nearly the same one if given."""
    mesh = graded_mesh(
        float(cap.surface(np.array(material))[0]),
        cap.outer,
        cap.thickness,
        cap.foot,
        contact_edge=CONTACT_EDGE,
        foot_edge=FOOT_EDGE,
    )
    body = SoftBody(mesh.refined(refinement) if refinement else mesh, cap, 2, 0.5)
    if start is not None and len(start.unknowns) != body.size:
        start = None
    stuck = None
    if earlier is not None:
        stuck = tuple(
            partial(part, earlier=earlier, unit=cap.radius) for part in (stuck_displacement, stick_mode)
        )
    return body.flatten(partial(sphere_profile, radius=cap.radius), stuck, start)


def tabulated_contact(
    contact_radius: ArrayLike,
    radius: float,
    *,
    height: float,
    thickness: float,
    block_radius: float,
    material: Material,
) -> TabulatedContact:
    """Return the contact law of a soft spherical cap at large strain, from `press_finite`.

    The plane slips on the cap. As in all contact laws, the indentation is that of the cap on a half-space: on
    a block of this thickness it is smaller by ``-P self_influence`` of `BondedLayer`, which coupled models
    add. The law includes the compliance of the pedestal. It takes about 6 s per contact radius; the load is
    within 0.2 % where the mesh resolves the contact (`FiniteContact.error_estimate`).

    Parameters
    ----------
    contact_radius : array_like, (m,)
        Increasing contact radii [mm] of the table, at least 3, below the radius of the cap's base.
    radius, height : float
        Radius of the sphere and height of its cap [mm], the height up to the radius.
    thickness, block_radius : float
        Thickness and radius of the block [mm].
    material : Material
        Incompressible; its E* scales the loads.

    Returns
    -------
    TabulatedContact

    Raises
    ------
    InvalidInput
        If a size does not fit the others, or the material is compressible.
    NotConverged
        If a contact does not converge.

    Examples
    --------
    >>> law = tabulated_contact(
    ...     [0.1, 0.2, 0.26], 0.526, height=0.2, thickness=7.2, block_radius=10.0, material=Material(1.36)
    ... )
    >>> round(float(law.table[1, -1]) / (1.36 * 4 / 3 * 0.26**3 / 0.526), 3)
    0.977
    """
    radii = check.array("contact_radius", contact_radius, shape=(None,), positive=True)
    check.instance("material", material, Material, "a metafem.Material")
    refuse_if(
        material.poisson_ratio != 0.5,
        f"material = {material!r} must have poisson_ratio = 0.5: at large strain the finite elements are "
        "incompressible",
    )
    check.increasing("contact_radius", radii)
    cap = checked_cap(float(radii[-1]), radius, height, thickness, "block_radius", block_radius)
    contacts = press_sequence(radii, cap, stick=False)
    load = np.array([contact.rescaled_load for contact in contacts])
    sunk = -BondedLayer(cap.thickness, 0.5).self_influence * load
    indentation = np.array([contact.indentation for contact in contacts]) + sunk
    return TabulatedContact(indentation, material.composite_modulus * load, math.pi * radii**2)
