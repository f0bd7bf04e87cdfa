"""Adhesive asperities that interact: the curves of `Interacting` under adhesive laws."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import JKR
from metafem.errors import InvalidInput, NotConverged
from metafem.models.adhesion.curves import Followed, follow, followed_near, jump_notes, refuse_merging
from metafem.models.adhesion.scene import Scene
from metafem.models.curve import Curve, RescaledState, Sensitivity
from metafem.models.interacting.cap_influence import pedestal_influence, pedestal_notes
from metafem.models.interacting.kept_coupling import coupling_between
from metafem.notes import Note
from metafem.surface import Surface

if TYPE_CHECKING:
    from metafem.models.interacting.model import Interacting

# Largest number of asperities: a state of so many takes a second, and each may jump.
MOST = 1000


def adhesive_curve(
    model: Interacting, law: JKR, surface: Surface, values: FloatArray, by_load: bool, unloading: bool
) -> Curve:
    """Return the curve of adhesive asperities at increasing loads or approaches (k,)."""
    refuse_merging(law, surface)
    modulus = surface.material.composite_modulus
    scene = _scene(model, law, surface, surface.height, surface.radius)
    found = follow(scene, values, by_load, unloading, modulus)
    notes = jump_notes(found.jumps, modulus, unloading) if by_load else ()
    return found.curve(partial(_last, model, surface, surface.height, found), notes)


def adhesive_sensitivity(
    model: Interacting, law: JKR, surface: Surface, load: FloatArray, height: FloatArray
) -> Sensitivity:
    """Return the law at increasing loads (k,) on loading, and dA0/dh at fixed load [mm], (k, n)."""
    scene = _scene(model, law, surface, height, surface.radius)
    found = followed_near(scene, load)
    indentation = np.array([found.indentation(state) for state in found.states])

    def gradient() -> FloatArray:
        gradient = found.gradients()
        if model.pedestal:
            _, rate = pedestal_influence(height, surface.radius)
            for row, state in zip(gradient, found.states, strict=True):
                if state is not None:
                    row[state.closed] *= 1.0 - rate[state.closed] * state.p
        return gradient

    curve = found.curve(partial(_last, model, surface, height, found), ())
    return Sensitivity(curve, gradient, indentation)


def adhesive_areas(
    model: Interacting,
    law: JKR,
    surface: Surface,
    load: FloatArray,
    height: FloatArray,
    radius: FloatArray | None,
) -> FloatArray:
    """Return A0 [mm^2] at increasing loads (k,) of many lists of heights (m, n), (m, k)."""
    found = np.full((len(height), len(load)), np.nan)
    for row, heights in enumerate(height):
        scene = _scene(model, law, surface, heights, surface.radius if radius is None else radius[row])
        try:
            states = followed_near(scene, load).states
        except NotConverged:
            continue
        found[row] = [0.0 if state is None else state.area for state in states]
    return found


def _scene(model: Interacting, law: JKR, surface: Surface, height: FloatArray, radius: FloatArray) -> Scene:
    """Return the asperities with their influence on each other."""
    if surface.count > MOST:
        raise InvalidInput(
            f"{surface.count} adhesive asperities with interaction are too many: at most {MOST}; use "
            "Independent or MeanField, or fewer asperities"
        )
    coupling, regular = coupling_between(surface, model.substrate.for_surface(surface), model.order)
    if model.pedestal:
        regular = regular + pedestal_influence(height, radius)[0]
    gap = height.max() - height
    return Scene(law, np.broadcast_to(radius, gap.shape), gap, coupling, regular)


def _last(model: Interacting, surface: Surface, height: FloatArray, found: Followed) -> RescaledState:
    """Return the last state."""
    load, area, indentation = found.last()
    base = height - indentation
    notes: tuple[Note, ...] = ()
    if model.pedestal:
        base = base - pedestal_influence(height, surface.radius)[0] * load
        notes = pedestal_notes(surface)
    return RescaledState(load, area, indentation, float(base.min()), model, notes)
