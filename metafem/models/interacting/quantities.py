"""Stiffness, conductance and sum of the contact radii of interacting asperities, and their sensitivities.

Each quantity Q depends on the loads p of the contacts. With H = d2W/dp2 of `_kernels.coupling` and
w = dQ/dp, the derivatives at fixed load are those of A0 in `sensitivity`, with w in place of dA0/dp:

    dQ/dh = l - (1.l / 1.m) m,   l = H^-1 w,   m = H^-1 1.

The stiffness is ``k = 1.y`` with H y = 1, and the rescaled conductance ``1.y`` with M y = 1, where M is the
matrix of `discs`. Both matrices have the compliances 1/(2 a) of the contacts on their diagonals, and

    w_i = -y.(dH/dp_i) y = y_i^2/(2 a_i^2) da_i/dp_i.

This is exact for order 1. For order 3 the changes of the other terms of the matrices are left out. The
error is 1e-4 of the largest derivative for paraboloids, and 5e-3 for power caps of n = 4 (measured).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

from metafem._kernels.coupling import Coupling, State, empty_state, respond, spread
from metafem._validate import FloatArray, IntArray
from metafem.contact.cap_compliance import pedestal_influence
from metafem.errors import refuse_if
from metafem.models.contact_tables import tables
from metafem.models.curve import Sensitivity
from metafem.models.interacting.discs import MOST, conductor_of, currents
from metafem.models.interacting.influence import coupling_between
from metafem.models.interacting.sensitivity import contact_system, influences_of

if TYPE_CHECKING:
    from metafem.models.interacting.elastic import ElasticCoupling

Quantity = Literal["stiffness", "conductance", "contact_radius"]


def quantity_sensitivity(
    bound: ElasticCoupling, of: Quantity, height: FloatArray, load: FloatArray
) -> Sensitivity:
    """Return the sensitivity of a quantity of asperities without adhesion at increasing loads (k,).

    The areas of its curve are the quantity [mm]: the rescaled stiffness, the rescaled conductance against an
    ideally conducting plane, or the sum of the contact radii.
    """
    refuse_if(
        bound.surface.count > MOST,
        f"targets of the {of.replace('_', ' ')} of interacting asperities need dense systems, for at most "
        f"{MOST} asperities; this surface has {bound.surface.count}",
    )
    found = bound.sensitivity(height, load)
    contacts = _Contacts(bound, height, found.indentation)
    conductor = conductor_of(bound, 1.0) if of == "conductance" else None
    if conductor is not None:
        flows = [currents(bound, conductor, math.pi * one.footprint, one.load) for one in contacts.states]
        values = np.array([current.sum() for current in flows])
    elif of == "stiffness":
        values = found.curve.stiffness
    else:
        values = np.array([np.sqrt(state.footprint).sum() for state in contacts.states])

    def gradient() -> FloatArray:
        total = np.zeros((len(load), len(height)))
        # change of the compliance of each cap by its height, per load
        softer = (
            pedestal_influence(height, bound.surface.radius)[1] if bound.pedestal else np.zeros(len(height))
        )
        for k, state in enumerate(contacts.states):
            closed = np.flatnonzero(state.footprint)
            square, wider = state.footprint[closed], state.by_load[closed]
            hessian, by_load = contacts.system(state, closed, 0.5 / (math.pi * np.sqrt(square)))
            uniform = np.linalg.solve(hessian, np.ones(closed.size))
            y = uniform if conductor is None else flows[k]
            if of != "contact_radius":
                by_load = 0.25 * y**2 * wider / square**1.5
            by_height = np.linalg.solve(hessian, by_load)
            change = by_height - by_height.sum() / uniform.sum() * uniform
            change *= 1.0 - softer[closed] * state.load[closed]
            total[k, closed] = change - (softer[closed] * y**2 if of == "stiffness" else 0.0)
        return total

    curve = replace(found.curve, area=values, friction_area=None)
    return Sensitivity(curve, gradient, found.indentation)


@dataclass(frozen=True, eq=False)
class _Contacts:
    """The contacts of asperities with heights (n,) at nominal indentations (k, n) [mm]."""

    bound: ElasticCoupling
    height: FloatArray
    indentation: FloatArray

    @cached_property
    def _field(self) -> tuple[Coupling, FloatArray, FloatArray]:
        """The influences, those for the derivatives, and the regular self terms with the pedestals."""
        bound = self.bound
        field, regular = coupling_between(bound.surface, bound.substrate, bound.order)
        return (
            field,
            influences_of(field, bound.order),
            regular + bound.pedestals(self.height, bound.surface.radius),
        )

    @cached_property
    def states(self) -> list[State]:
        """The state of each equilibrium."""
        law, order = tables(self.bound.law, self.bound.law.summits(self.bound.surface)), self.bound.order
        field, _, self_term = self._field
        states = [empty_state(len(self.height)) for _ in self.indentation]
        for state, z in zip(states, self.indentation, strict=True):
            state.z[:] = z
            respond(field, order, law, self_term, state)
            spread(order, law, state)
        return states

    def system(self, state: State, closed: IntArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return H and the derivatives by the loads of the sum of areas with weights, for closed contacts."""
        _, influences, self_term = self._field
        return contact_system(influences, self_term, state, closed, weights)
