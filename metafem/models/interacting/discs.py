"""Conductance of interacting contacts: conducting discs between two bodies.

A disc of radius a at the potential V in a potential u carries the current of the elastic problem of a flat
punch (Barber, Proc. R. Soc. A 459, 53 (2003), doi:10.1098/rspa.2002.1038). With the currents
``j = (rho_1 + rho_2) I/(2 V)`` [mm] and the influence G of the conductor, order 1 is

    j_i/(2 a_i) + sum_j G_ij j_j = 1.

Order 3 adds what the elastic model of order 3 contains as well: the mean of the potential over a disc,
``a_i^2/6 lap G``, and the same for the disc as a source; the displacement ``s_i = -(2 a/D') g_i`` of the
contact down the slope g of the displacement field; and the currents that a disc carries in the slope and the
curvature of a potential, ``4/3 a^3`` and ``2/45 a^5``. The rescaled conductance ``sum_i j_i`` is (rho_1 +
rho_2) G/2.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.errors import InvalidInput
from metafem.models.interacting.influence import coupling_between
from metafem.substrate import Radial

if TYPE_CHECKING:
    from metafem.models.interacting.coupled import Coupled

# Largest number of asperities; the dense system of as many takes about a second.
MOST = 2000

# Newton steps from the radius of a contact in a curved field, which differs by less than a few per cent.
STEPS = 4


def conductor_of(bound: Coupled, share: float) -> Radial:
    """Return the substrate of the currents, or raise InvalidInput if they cannot be computed."""
    substrate = bound.substrate
    if not isinstance(substrate, Radial):
        raise InvalidInput(
            f"{type(substrate).__name__} has no conduction: the conductance of contacts needs "
            "metafem.HalfSpace() or metafem.BondedLayer()"
        )
    if bound.surface.count > MOST:
        raise InvalidInput(
            f"the conductance of {bound.surface.count} interacting asperities is too large a system: at most "
            f"{MOST}; on a half-space, Barber's identity gives it as 2 k/(E* (rho_1 + rho_2))"
        )
    return substrate.conductor(share)


def conductances(bound: Coupled, load: FloatArray, share: float) -> FloatArray:
    """Return the rescaled conductances [mm] of asperities with their influence, at loads (k,) [mm^2]."""
    conductor, found = conductor_of(bound, share), np.zeros(len(load))
    for k, value in enumerate(load):
        last = bound.model.curve(bound.surface, np.array([value])).checked().last
        found[k] = currents(bound, conductor, last.area, last.load).sum()
    return found


def currents(bound: Coupled, conductor: Radial, area: FloatArray, load: FloatArray) -> FloatArray:
    """Return the currents j [mm] of those of n asperities in contact, for areas and loads (n,) [mm^2]."""
    closed = np.flatnonzero(area > 0.0)
    radius = np.sqrt(area[closed] / math.pi)
    matrix = _resistance(bound, conductor, closed, radius, load)
    return np.asarray(np.linalg.solve(matrix, np.ones(closed.size)))


def _resistance(
    bound: Coupled, conductor: Radial, closed: IntArray, radius: FloatArray, load: FloatArray
) -> FloatArray:
    """Return the matrix [1/mm] from currents through the contacts to potentials."""
    field, regular = coupling_between(bound.surface, conductor, bound.order)
    inside = np.ix_(closed, closed)
    matrix = field.influence[inside] + np.diag(0.5 / radius + regular[closed])
    if bound.order == 1:
        return matrix
    # derivatives at asperity i of the potential by j
    lap, gx, gy = (part[inside].T for part in (field.laplacian_at, field.slope_x_at, field.slope_y_at))
    elastic, _ = coupling_between(bound.surface, bound.substrate, bound.order)
    slope_x, slope_y = (load @ part for part in (elastic.slope_x_at, elastic.slope_y_at))
    law, summits = bound.law, bound.law.summits(bound.surface)[closed]
    lever = 2.0 * radius / law.profile_slope(radius, summits)
    shift_x, shift_y = (-lever * slope[closed] for slope in (slope_x, slope_y))
    mixed = (radius**2 / 6.0)[:, None] * lap + shift_x[:, None] * gx + shift_y[:, None] * gy
    matrix += mixed + mixed.T
    matrix -= lap.T @ ((2.0 / 45.0 * radius**5)[:, None] * lap)
    flat = radius if law.adhesive else _without_curvature(law, radius, summits, load[closed])
    for part in (gx, gy):
        matrix -= part.T @ ((4.0 / 3.0 * flat**3)[:, None] * part)
    return matrix


def _without_curvature(law: Contact, radius: FloatArray, summits: FloatArray, load: FloatArray) -> FloatArray:
    """Return the contact radii [mm] at which the law without extra curvature has these loads [mm^2].

    The elastic model of order 3 computes the moment of a tilted contact for them.
    """
    a = radius
    for _ in range(STEPS):
        a = a - (law.load(a, summits) - load) / (law.stiffness(a, summits) * law.profile_slope(a, summits))
    return a
