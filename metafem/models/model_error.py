"""Estimated error of A0(P) of a model, compared with resolved contacts on the same substrate.

Each model is judged by the cheapest estimate that suffices:

- independent asperities: by the displacements due to the loads of the contacts
  (`rungs.independent_error`) if this error is below `SMALL`; otherwise by the solution of the model of the
  highest order. This model is on a bonded layer if the surface has a block, else on a half-space;
- order 1: by the solution of order 3;
- order 3: by the contact radii (`truncation`); this error is also part of the estimates above;
- resolved contacts: by the number of their cells.

`BoundaryElements` and `Automatic` estimate their error while they solve, and return it with the curve.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any, TypeVar, cast

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.errors import MetafemError
from metafem.models.curve import Curve, ModelError
from metafem.models.independent import Independent, load_equation
from metafem.models.interacting.model import DENSE_LIMIT, Interacting
from metafem.models.model import Model, contact_of
from metafem.models.rungs import DISPLACEMENTS, PROBED, independent_error, order_3_error
from metafem.substrate import BondedLayer, HalfSpace
from metafem.surface import Surface

# Largest error of uncoupled asperities that is estimated by the displacements due to their loads. Larger
# errors are computed with a coupled model; the estimate would be wrong by up to a factor of three.
SMALL = 0.01

# Number of loads at which models are compared: at least PROBES, and as many as there are with PROBED contacts
# in all; FEW_PROBES for surfaces too large for the dense solver.
PROBES, FEW_PROBES = 8, 3

# Largest number of adhesive asperities whose jumps are followed to estimate the interaction. For larger
# surfaces this takes too long, and the interaction is estimated without adhesion.
MOST_ADHESIVE = 100

M = TypeVar("M", bound=Model)


def model_error(surface: Surface, model: Model, curve: Curve, unloading: bool = False) -> ModelError:
    """Return the estimated error of a model along a curve; nan with the reason if it cannot be estimated.

    `unloading` says whether the states of the curve are those on unloading from its largest load.
    """
    law = contact_of(model)
    if curve.error is not None:
        return curve.error
    if not curve.converged:
        return ModelError(math.nan, "the model has no solution")
    if not curve.area.any():
        return ModelError(0.0, "there is no contact")
    if not (curve.load > 0.0).any():
        return ModelError(math.nan, "the loads are not positive")
    bare = without_jumps(surface, model)
    if bare != model:
        return model_error(surface, bare, bare.curve(surface, curve.load[curve.load > 0.0]))
    if model == model.reference:
        return order_3_error(surface, curve.last.area, model.reference.substrate, law)
    if model != model.gradient_model:
        return ModelError(math.nan, f"the model {model.name} states no error")
    reference = model.reference if model.couples else reference_of(surface, model)
    if not (model.couples or law.adhesive or law.largest_order == 1):
        bound = reference.substrate.for_surface(surface)
        independent = Independent(law)
        alone = curve if model == independent else independent.curve(surface, curve.load)
        equation = load_equation(law.bound(surface), independent)
        error, _ = independent_error(equation, surface, bound, alone, SMALL)
        if error <= SMALL:
            return ModelError(error, DISPLACEMENTS)
    return compared(surface, reference, curve, unloading)


def without_jumps(surface: Surface, model: M) -> M:
    """Return a model without adhesion if the contacts adhere and are too many; otherwise the model itself."""
    law = contact_of(model)
    if not law.adhesive or surface.count <= MOST_ADHESIVE:
        return model
    return cast("M", replace(cast("Any", model), contact=law.without_adhesion))


def reference_of(surface: Surface, model: Model) -> Interacting:
    """Return the reference model for a model and a surface; on a bonded layer if the surface has a block."""
    reference = model.reference
    if surface.block is not None and reference.substrate == HalfSpace():
        return replace(reference, substrate=BondedLayer())
    return reference


def rung_name(model: Interacting) -> str:
    """Return the order and the substrate of a model in words, such as "order 3 on the half-space"."""
    names = {"layer": "bonded layer"}
    substrate = getattr(model.substrate, "name", type(model.substrate).__name__)
    return f"order {model.order} on the {names.get(substrate, substrate)}"


def _on_path(model: Model, surface: Surface, load: FloatArray, unloading: bool) -> Curve:
    """Return the curve of a model on loading, or on unloading from the largest load."""
    if unloading:
        return cast("Curve", cast("Any", model).curve(surface, load, unloading=True))
    return model.curve(surface, load)


def compared(surface: Surface, reference: Interacting, curve: Curve, unloading: bool = False) -> ModelError:
    """Return the error of a curve by comparison with a reference model, whose own error is added.

    At least one of the loads is positive.
    """
    rows = _probed(curve.load, surface.count)
    load, law, source = curve.load[rows], reference.contact, rung_name(reference)
    try:
        full = _on_path(reference, surface, load, unloading)
        change = full.area[full.solved] / curve.area[rows][full.solved] - 1.0
        if not full.converged:
            newtons = surface.material.composite_modulus * load[~full.solved][0]
            source = f"order {reference.order} has no solution at {newtons:.4g} N"
            return ModelError(math.nan, source, load[full.solved], change, solved=False)
        rest = order_3_error(surface, full.last.area, reference.substrate, law)
    except MetafemError as reason:
        return ModelError(math.nan, str(reason), solved=False)
    own = float(np.abs(change).max()) + rest
    return ModelError(own, rest.source if math.isnan(rest) else source, load, change)


def _probed(load: FloatArray, count: int) -> IntArray:
    """Return the indices of at most a few positive loads, including the last one."""
    rows: IntArray = np.flatnonzero(load > 0.0)
    some = max(PROBES, PROBED // count) if count <= DENSE_LIMIT else FEW_PROBES
    if rows.size <= some:
        return rows
    ends: IntArray = np.rint(np.arange(1, some + 1) * rows.size / some).astype(np.int64) - 1
    return rows[ends]
