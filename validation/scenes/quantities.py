"""Exact stiffness of interacting contacts."""

from __future__ import annotations

import numpy as np

import metafem as mf
from metafem._kernels.coupling import empty_state, respond, spread
from metafem.models.contact_tables import tables
from metafem.models.interacting.influence import coupling_between
from metafem.models.interacting.sensitivity import contact_system, influences_of


def exact_stiffness(model: mf.Interacting, surface: mf.Surface, loads: np.ndarray) -> np.ndarray:
    """Return dP/dx [mm] at loads [mm^2] from the Hessian of the energy, solved without approximation."""
    bound = model.bound(surface)
    law = tables(bound.law, bound.law.summits(surface))
    field, self_term = coupling_between(surface, bound.substrate, bound.order)
    state, found = empty_state(surface.count), []
    for z in bound.sensitivity(surface.height, loads).indentation:
        state.z[:] = z
        count = respond(field, bound.order, law, self_term, state)
        spread(bound.order, law, state)
        closed, same = state.closed[:count], np.ones(count)
        hessian, _ = contact_system(influences_of(field, bound.order), self_term, state, closed, same)
        found.append(np.linalg.solve(hessian, np.ones(count)).sum())
    return np.array(found)
