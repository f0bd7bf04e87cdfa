"""Exact stiffness of interacting contacts, and conductance on a grounded layer by the series of images."""

from __future__ import annotations

import math

import numpy as np

import metafem as mf
from metafem._kernels.coupling import empty_state, respond, spread
from metafem.models.contact_tables import tables
from metafem.models.interacting.influence import coupling_between
from metafem.models.interacting.sensitivity import contact_system, influences_of

# Rescaled loads [mm^2], thickness of the layer [mm], and side of the cells of resolved contacts [mm].
LOADS, THICKNESS, CELL = np.array([0.1, 0.3]), 7.2, 0.005

BLOCK = mf.Block(20.0, 20.0, THICKNESS)

# Number of images, of which half as many are averaged with them.
IMAGES = 200_000

MATERIAL = mf.Material(1.36)

ENERGY, RADIUS = 9e-6, 0.526


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


def by_images(distance: np.ndarray) -> np.ndarray:
    """Return the regular part of the influence of a grounded layer [1/mm], by the series of images."""
    m = np.arange(1, IMAGES + 1)
    found = []
    for r in np.ravel(distance):
        parts = np.cumsum(2.0 * (-1.0) ** m / np.hypot(r, 2.0 * m * THICKNESS))
        found.append(0.25 * (parts[-3] + 2.0 * parts[-2] + parts[-1]) / math.pi)
    return np.array(found).reshape(np.shape(distance))


def discs_by_images(surface: mf.Surface) -> np.ndarray:
    """Return the rescaled conductance of order 1 on the grounded layer [mm], with the series of images."""
    model, found = mf.Interacting(1, substrate=mf.BondedLayer()), []
    x, y = surface.position.T
    r = np.hypot(x[:, None] - x, y[:, None] - y)
    apart = np.where(r > 0.0, r, 1.0)
    matrix = np.where(r > 0.0, 1.0 / (math.pi * apart), 0.0) + by_images(r)
    for load in LOADS:
        radius = np.sqrt(model.curve(surface, np.array([load])).last.area / math.pi)
        closed = np.flatnonzero(radius)
        system = matrix[np.ix_(closed, closed)] + np.diag(0.5 / radius[closed])
        found.append(np.linalg.solve(system, np.ones(closed.size)).sum())
    return np.array(found)


def error(found: np.ndarray, expected: np.ndarray) -> float:
    """Return the largest relative difference."""
    return float(np.abs(found / expected - 1.0).max())
