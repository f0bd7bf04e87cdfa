"""A true cap of incompressible rubber under a rigid plane at large strain, with slip or with stick."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from metafem import _validate as check
from metafem._validate import FloatArray
from metafem.contact.cap_geometry import sphere_profile
from metafem.errors import InvalidInput, NotConverged
from metafem.fe.axisymmetric.geometry import Cap
from metafem.fe.axisymmetric.mesh import graded_mesh
from metafem.fe.large_strain.body import Flattened, NewtonStatus, SoftBody

# Size of the last elements at the edge, relative to the contact's radius: the edge's bracket is of this
# order, small beside the error of quadratic elements.
CONTACT_EDGE = 1e-4

# Size of the elements at the cap's foot, relative to its radius. The corner closes like a crease, which a
# fine mesh would resolve into a fold; coarse elements round it off, without effect on the contact.
FOOT_EDGE = 0.05

# Times that the graded mesh is halved: for the result, and for the coarser one that judges it.
REFINEMENTS = (1, 0)

# Relative error of the deformed radius at which the search for the material point ends, and its steps: each
# gains three digits or more, as radius and material point differ by a few percent.
RADIUS_ERROR, SEARCH = 1e-7, 12

# Contacts of the history of a stuck one: at a/R = 0.5 half as many change the load by 1e-4, twice as many by
# 2e-6.
HISTORY = 4


@dataclass(frozen=True, eq=False)
class FiniteContact:
    """One contact of a soft cap under a rigid plane in the deformed state.

    Attributes
    ----------
    contact_radius : float
        a, in the deformed state [mm].
    material_radius : float
        Undeformed radius of the points at the contact's edge [mm].
    rescaled_load : float
        P/E* [mm^2], E* = 4/3 E = 4 mu.
    indentation : float
        Approach of the plane to the bonded base from first touch [mm].
    error_estimate : float
        Relative, of load and indentation: what a mesh of twice the cells changes (with stick also half the
        steps of the history) and the bracket of the edge. It bounds the error of the discretisation of
        this body; what another height or block changes is not in it.
    residual : float
        Largest nodal force out of balance, relative to the load.
    status : NewtonStatus
    """

    contact_radius: float
    material_radius: float
    rescaled_load: float
    indentation: float
    error_estimate: float
    residual: float
    status: NewtonStatus
    state: Flattened = field(repr=False)


def press_finite(
    contact_radius: float,
    radius: float,
    *,
    height: float,
    thickness: float,
    block_radius: float,
    stick: bool = False,
) -> FiniteContact:
    """Press a rigid plane on a soft spherical cap until the deformed contact's radius is `contact_radius`.

    Large strain, axisymmetric, incompressible neo-Hookean: ``W = mu/2 (F:F - 3)`` with ``J = 1`` and
    E* = 4 mu, quadratic displacements and linear pressures in the undeformed frame. The points up to a
    material radius lie on the plane; the plane's place is the one at which no force acts on the last of
    them, the same condition as regularity of the pressure's edge. The material radius is the one whose
    deformed radius is asked for. The body is the cap of `height` on a block bonded to a rigid base, with
    free sides, as in `press`.

    Points slip without friction; or, with `stick`, keep the place on the plane where they came into
    contact, ``r = a(s)`` for the undeformed radius s, which a history of growing contacts determines one
    by one: no shear force acts on the last point either.

    Parameters
    ----------
    contact_radius : float
        a [mm], less than the radius of the cap's base.
    radius, height : float
        Of the sphere and its cap [mm], height up to the radius.
    thickness, block_radius : float
        Of the block [mm].
    stick : bool
        Whether points that touch keep their place.

    Returns
    -------
    FiniteContact

    Raises
    ------
    InvalidInput
        If a size is not positive or does not fit the others.
    NotConverged
        If Newton's method or the search for the material radius does not end; with the last state.

    Notes
    -----
    With h/R = 0.38, P(a) is 0.989 of Hertz's at a/R = 0.1, 0.974 at 0.4 and 0.978 at 0.5, where small
    strain (`press`) gives 1.11: small strain errs more than Hertz's law, and with the opposite sign. It
    must not be used to improve Hertz's P(a) of soft bodies at large a/R; Hertz with a fitted E* is the
    better law.

    Examples
    --------
    >>> contact = press_finite(0.26, 0.526, height=0.2, thickness=7.2, block_radius=10.0)
    >>> round(contact.rescaled_load / (4 / 3 * 0.26**3 / 0.526), 3)
    0.977
    """
    a = check.number("contact_radius", contact_radius, above=0.0)
    if not isinstance(stick, (bool, np.bool_)):
        raise InvalidInput(f"stick = {stick!r:.60} must be True or False")
    cap = _cap(a, radius, height, thickness, block_radius)
    radii = a * np.arange(1, HISTORY + 1) / HISTORY if stick else np.array([a])
    return press_in_turn(radii, cap, stick)[-1]


def press_in_turn(
    radii: FloatArray, cap: Cap, stick: bool, refinements: tuple[int, int] = REFINEMENTS
) -> list[FiniteContact]:
    """Contacts of increasing radii; with stick each is the history of the following ones."""
    coarse = _march(radii, cap, stick, refinements[1], [])
    fine = _march(radii, cap, stick, refinements[0], [c.material_radius for c in coarse])
    change = [_change(one, two) for one, two in zip(fine, coarse, strict=True)]
    if stick and len(radii) > 1:
        # Every second step of the history, the last one included.
        half = _march(radii[::-2][::-1], cap, stick, refinements[1], [])
        change[-1] += _change(half[-1], coarse[-1])
    return [
        replace(one, error_estimate=one.error_estimate + extra)
        for one, extra in zip(fine, change, strict=True)
    ]


def _change(one: FiniteContact, two: FiniteContact) -> float:
    return max(abs(one.rescaled_load / two.rescaled_load - 1.0), abs(one.indentation / two.indentation - 1.0))


def _march(
    radii: FloatArray, cap: Cap, stick: bool, refinement: int, guesses: list[float]
) -> list[FiniteContact]:
    """Contacts on one family of meshes, in turn."""
    stuck = _Stuck(cap.radius) if stick else None
    contacts: list[FiniteContact] = []
    for i, a in enumerate(radii):
        guess = guesses[i] if guesses else a * (contacts[-1].material_radius / radii[i - 1] if i else 1.0)
        contacts.append(_find(float(a), cap, stuck, refinement, float(guess)))
        if stuck is not None:
            stuck.add(contacts[-1].material_radius, contacts[-1].state.shift)
    return contacts


class _Stuck:
    """Radial displacement at first touch, by the undeformed radius s: ``s^3`` times Newton's polynomial.

    Without a term of s^2: at small strain an incompressible surface does not move sideways.
    """

    def __init__(self, unit: float) -> None:
        self.unit = unit
        self.places: list[float] = []
        self.shares: list[float] = []

    def mode(self, s: FloatArray, count: int | None = None) -> FloatArray:
        """Term that vanishes at the places of the first `count` contacts, of all so far by default."""
        result = self.unit * (s / self.unit) ** 3
        for place in self.places[:count]:
            result = result * (s - place) / self.unit
        return np.asarray(result)

    def displacement(self, s: FloatArray) -> FloatArray:
        """Sum of the terms so far."""
        result = np.zeros_like(s)
        for i, share in enumerate(self.shares):
            result += share * self.mode(s, i)
        return result

    def add(self, place: float, share: float) -> None:
        """Take up a contact."""
        self.places.append(place)
        self.shares.append(share)


def _find(a: float, cap: Cap, stuck: _Stuck | None, refinement: int, guess: float) -> FiniteContact:
    """Find the material radius whose deformed one is a, by the secant."""
    state: Flattened | None = None
    place, before = guess, (0.0, 0.0)
    for _ in range(SEARCH):
        if not place < cap.foot:
            raise InvalidInput(f"contact_radius = {a:g} brings the cap's edge at {cap.foot:g} into contact")
        state = _flatten(place, cap, stuck, refinement, state)
        if abs(state.edge / a - 1.0) <= RADIUS_ERROR:
            return FiniteContact(
                a, place, state.load, state.indentation, state.bracket, state.residual, state.status, state
            )
        slope = (state.edge - before[1]) / (place - before[0])
        before, place = (place, state.edge), place + (a - state.edge) / slope
    raise NotConverged(f"no material radius found for the contact radius {a:g}", state)


def _flatten(
    place: float, cap: Cap, stuck: _Stuck | None, refinement: int, start: Flattened | None
) -> Flattened:
    """Flatten the cap up to one material radius, from a state with nearly the same if there is one."""
    mesh = graded_mesh(
        float(cap.surface(np.array(place))[0]),
        cap.outer,
        cap.thickness,
        cap.foot,
        contact_edge=CONTACT_EDGE,
        foot_edge=FOOT_EDGE,
    )
    body = SoftBody(mesh.refined(refinement) if refinement else mesh, cap, 2, 0.5)
    if start is not None and len(start.unknowns) != body.size:
        start = None
    return body.flatten(
        partial(sphere_profile, radius=cap.radius),
        None if stuck is None else (stuck.displacement, stuck.mode),
        start,
    )


def _cap(a: float, radius: Any, height: Any, thickness: Any, block_radius: Any) -> Cap:
    """Check the sizes against each other."""
    big = check.number("radius", radius, above=0.0)
    h = check.number("height", height, above=0.0, at_most=big)
    t = check.number("thickness", thickness, above=0.0)
    side = check.number("block_radius", block_radius, above=0.0)
    if t < h:
        raise InvalidInput(f"thickness = {t:g} must be at least the cap's height = {h:g}")
    foot = math.sqrt(h * (2.0 * big - h))
    if foot >= side:
        raise InvalidInput(f"the cap's foot of radius {foot:g} must lie within block_radius = {side:g}")
    if a >= foot:
        raise InvalidInput(f"contact_radius = {a:g} must lie within the cap's edge at {foot:g}")
    return Cap(big, h, side, t)
