"""Spherical cap of incompressible rubber under a rigid plane at large strain, with slip or stick."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from metafem._validate import FloatArray
from metafem.caps.shapes import sphere_profile
from metafem.errors import NotConverged, refuse_if
from metafem.fe.geometry import Cap, graded_mesh
from validation.finite_elements.large_strain.body import FiniteContact, SoftBody

# Size of the smallest elements at the contact's edge, over the contact radius. The error due to the position
# of the edge is of this order, which is below the error of the quadratic elements.
CONTACT_EDGE = 1e-4

# Size of the smallest elements at the cap's foot, over the foot radius. The corner closes to a crease, in
# which a fine mesh would fold. Coarse elements smooth the crease without an effect on the contact.
FOOT_EDGE = 0.05

# Number of refinements of the graded mesh: for the result, and for the coarser solution of the error
# estimate.
REFINEMENTS = (1, 0)

# Largest relative error of the deformed radius, and largest number of secant steps for the material radius.
# Each step gains at least three digits, because the two radii differ by only a few percent.
RADIUS_ERROR, SECANT_STEPS = 1e-7, 12

# Number of increasing contacts with stick. At a/R = 0.5 half this number changes the load by 1e-4, and twice
# this number by 2e-6.
HISTORY = 4


def press_finite(contact_radius: float, cap: Cap, stick: bool = False) -> FiniteContact:
    """Return the contact of prescribed deformed radius [mm] between a rigid plane and a soft cap.

    The body is axisymmetric, incompressible and neo-Hookean: ``W = mu/2 (F:F - 3)`` with ``J = 1`` and
    ``E* = 4 mu``. The elements have quadratic displacements and linear pressures in the undeformed
    configuration. All points up to a material radius lie on the plane. The indentation is chosen so that no
    force acts on the last of these points and the pressure is finite at the edge. The material radius is
    chosen so that its deformed value is `contact_radius`. The cap is part of a block with a bonded base and
    free sides, as in `metafem.fe.press`.

    The points slip without friction or, with `stick`, remain where they first touched the plane. A point with
    the undeformed radius s then remains at ``r = a(s)``. A sequence of increasing contacts determines this
    function; in each contact, no shear force acts on the last point.
    """
    count = HISTORY if stick else 1
    return press_sequence(contact_radius * np.arange(1, count + 1) / count, cap, stick)[-1]


def press_sequence(
    radii: FloatArray, cap: Cap, stick: bool, refinements: tuple[int, int] = REFINEMENTS
) -> list[FiniteContact]:
    """Return contacts of increasing radii; with stick, each contact depends on the previous ones."""
    coarse = _on_mesh(radii, cap, stick, refinements[1], [])
    fine = _on_mesh(radii, cap, stick, refinements[0], [c.material_radius for c in coarse])
    change = [_change(one, two) for one, two in zip(fine, coarse, strict=True)]
    if stick and len(radii) > 1:
        # every second contact, including the last
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
    """Return contacts of increasing radii on meshes with the same number of refinements."""
    contacts: list[FiniteContact] = []
    for i, a in enumerate(radii):
        guess = guesses[i] if guesses else a * (contacts[-1].material_radius / radii[i - 1] if i else 1.0)
        contacts.append(_contact(float(a), cap, contacts if stick else None, refinement, float(guess)))
    return contacts


def stick_mode(s: FloatArray, earlier: list[FiniteContact], unit: float) -> FloatArray:
    """Return the term of the radial displacement [mm] that is zero at the edges of the earlier contacts.

    The radial displacement at which points first touch the plane is ``s^3`` times a Newton polynomial in the
    undeformed radius s. There is no term s^2, because at small strain an incompressible surface does not move
    radially.
    """
    factors = [(s - contact.material_radius) / unit for contact in earlier]
    return np.asarray(unit * (s / unit) ** 3 * np.prod([np.ones_like(s), *factors], axis=0))


def stuck_displacement(s: FloatArray, earlier: list[FiniteContact], unit: float) -> FloatArray:
    """Return the radial displacement [mm] of points that have stuck since earlier contacts."""
    terms = (contact.shift * stick_mode(s, earlier[:i], unit) for i, contact in enumerate(earlier))
    return sum(terms, start=np.zeros_like(s))


def _contact(
    a: float, cap: Cap, earlier: list[FiniteContact] | None, refinement: int, guess: float
) -> FiniteContact:
    """Return the contact with the deformed radius a; the secant method finds the material radius.

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
    """Return the cap flattened up to a material radius; `start` is a state with nearly the same radius."""
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
