"""Estimated error of A0(P) of a model, compared with resolved contacts on the same substrate.

Each model is judged along its curve by the cheapest estimate that suffices:

- independent asperities: by the displacements ``u = G p`` due to the loads p of the contacts
  (`independent_errors`) up to an error of `SMALL`; beyond it by the solution of the model of the highest
  order. This model is on a bonded layer if the surface has a block, else on a half-space;
- order 1: by the solution of order 3;
- order 3: by the contact radii (`truncation`); this error is also part of the estimates above;
- resolved contacts: by the number of their cells.

`BoundaryElements` and `Automatic` estimate their error while they solve, and return it with the curve.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import scipy

from metafem._kernels import independent as kernel
from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import area_change, sizes_of
from metafem.errors import MetafemError
from metafem.models.contact_tables import tables
from metafem.models.curve import Curve, ModelError
from metafem.models.independent import Independent, load_equation
from metafem.models.interacting.influence import close_pairs, displacements, nearest_distance, neighbours
from metafem.models.interacting.model import Interacting
from metafem.models.model import Model, contact_of
from metafem.substrate import BondedLayer, HalfSpace, Radial, Substrate
from metafem.surface import Surface

# Sources of the estimates.
DISPLACEMENTS = "the displacements by the loads of independent contacts"
RADII = "the contact radii relative to the distances and the thickness"

# Largest error of uncoupled asperities that is estimated by the displacements due to their loads. Larger
# errors are computed with a coupled model; the estimate would be wrong by up to a factor of three.
SMALL = 0.01

# Number of contacts, summed over the loads, up to which errors are estimated at all loads, and least number
# of loads: 100 loads of 64 contacts take .2 ms.
PROBED, FEWEST = 6400, 8

# Safety factor of the estimates; a quarter is also added to the estimates of order 3. In 1500 random scenes
# the errors were up to 1.3 times the estimates without this factor.
SAFETY = 1.25

# Largest number of adhesive asperities whose jumps are followed to estimate the interaction. For larger
# surfaces this takes too long, and the interaction is estimated without adhesion.
MOST_ADHESIVE = 100


def model_error(surface: Surface, model: Model, curve: Curve, unloading: bool = False) -> ModelError:
    """Return the largest error of a model along a curve; nan with the reason if it cannot be estimated.

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
    reference = model.reference if model.couples else reference_of(surface, model)
    if model == model.reference:
        if law.largest_order == 1 or len(curve.load) == 1:
            return order_3_error(surface, curve.last.area, reference.substrate, law)
        _, errors = coupled(surface, reference, curve.load[judged(surface, curve)])
        return largest(errors, RADII)
    if model != model.gradient_model:
        return ModelError(math.nan, f"the model {model.name} states no error")
    if model == Independent(law) and law.largest_order == 3:
        _, errors = independent_errors(surface, law, reference.substrate, curve)
        if errors.max() <= SMALL:
            return largest(errors, DISPLACEMENTS)
    return compared(surface, reference, curve, unloading)


def without_jumps(surface: Surface, model: Any) -> Any:
    """Return a model without adhesion if the contacts adhere and are too many; otherwise the model itself."""
    law = contact_of(model)
    if not law.adhesive or surface.count <= MOST_ADHESIVE:
        return model
    return replace(model, contact=law.without_adhesion)


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


def compared(surface: Surface, reference: Interacting, curve: Curve, unloading: bool = False) -> ModelError:
    """Return the error of a curve by comparison with a reference model, whose own error is added.

    At least one of the loads is positive.
    """
    rows = judged(surface, curve)
    load, law, source = curve.load[rows], reference.contact, rung_name(reference)
    try:
        if law.largest_order == 3:
            full, rest = coupled(surface, reference, load)
            if not (rest < 0.1).all():
                reference.curve(surface, load)  # refuses contacts that are wider than the layer or the cell
        else:
            full, rest = reference.curve(surface, load, unloading=unloading), np.zeros(len(load))
    except MetafemError as reason:
        return ModelError(math.nan, str(reason), solved=False)
    change = full.area[full.solved] / curve.area[rows][full.solved] - 1.0
    if not full.converged:
        newtons = surface.material.composite_modulus * load[~full.solved][0]
        source = f"order {reference.order} has no solution at {newtons:.4g} N"
        return ModelError(math.nan, source, load[full.solved], change, solved=False)
    error = largest(np.abs(change) + rest, source)
    if law.largest_order == 1:
        error = order_3_error(surface, full.last.area, reference.substrate, law)
    return ModelError(error, error.source, load, change)


def judged(surface: Surface, curve: Curve) -> IntArray:
    """Return the indices of the positive loads at which errors are estimated, with the first and the last.

    With many contacts a load is judged when the number of those closed has risen by 2^(1/4): each that closes
    changes A0 by a fraction of about the inverse of their number.
    """
    rows = np.flatnonzero(curve.load > 0.0)
    if rows.size <= max(FEWEST, PROBED // surface.count):
        return rows
    even = np.arange(FEWEST) * (rows.size - 1) // (FEWEST - 1)
    closed = np.searchsorted(np.sort(surface.gap), curve.approach[rows])
    level = (4.0 * np.log2(np.maximum(closed, 1))).astype(int)
    return rows[np.union1d(even, np.flatnonzero(np.diff(level)) + 1)]


def coupled(surface: Surface, model: Interacting, load: FloatArray) -> tuple[Curve, FloatArray]:
    """Return the curve of a model of order 3, and its errors at each load, (k,); see `truncation`.

    The error of a load without a solution is nan. The contact areas are in proportion to those at the nominal
    indentations, which leave out the curvature and the slope of the neighbours' field.
    """
    equation = load_equation(model.contact.bound(surface))
    curves, errors = [], []
    # the areas of two million contacts, 16 MB, are kept at a time
    for some in np.array_split(load, math.ceil(len(load) * surface.count / 2e6)):
        found = model.sensitivity(surface, some)
        _, _, area, _ = equation.rates(found.indentation, equation.law.summits(surface))
        area *= (found.curve.area / _total(area))[:, None]
        error = truncation(surface, area, model.substrate, model.contact)
        curves.append(found.curve)
        errors.append(np.where(found.curve.solved, error, math.nan))
    return Curve.joined(curves), np.concatenate(errors)


def independent_errors(
    surface: Surface, law: Contact, substrate: Substrate, curve: Curve
) -> tuple[Curve, FloatArray]:
    """Return the curve of independent asperities on a sinking base, and their errors at its loads, (k,).

    At fixed load the base sinks by ``U = sum k_i u_i / sum k_i`` with the stiffnesses k of the contacts, and
    the indentations change by ``U - u_i``. The law then gives new loads, with which the step is repeated.
    Errors, sinking and its derivative by the load are interpolated between judged loads.
    """
    rows = judged(surface, curve)
    if not rows.size:
        return curve, np.zeros(len(curve.load))
    bound, base = law.bound(surface), substrate.for_surface(surface)
    table, displaced = tables(bound, bound.summits(surface)), displacements(surface, base)
    load, area, z = curve.load[rows], curve.area[rows], curve.approach[rows, None] - surface.gap
    own, rate, areas, area_rate, pressed, again = np.empty((6, *z.shape))
    (sinking, bend, first), (_, _, second) = results = np.empty((2, 3, len(load)))
    kernel.rates(table, z, own, rate, areas, area_rate)
    kernel.sink(table, z, rate, area_rate, displaced(own), load, pressed, results[0])
    kernel.sink(table, z, rate, area_rate, displaced(pressed), load, again, results[1])
    error = SAFETY * (np.abs(second - area) + 0.5 * np.abs(second - first)) / area
    error += _higher_orders(bound, surface, base, own, areas)
    slope = bend + np.einsum("ij,ij->i", rate, displaced(rate)) / rate.sum(axis=1) ** 2
    at = curve.load
    error, depth, slope = (np.interp(at, load, part) for part in (error, sinking / load, slope))
    approach, stiffness = curve.approach + at * depth, curve.stiffness / (1.0 + slope * curve.stiffness)
    return replace(curve, approach=approach, stiffness=stiffness, compute_last=lambda: curve.last), error


def _higher_orders(
    law: Contact, surface: Surface, substrate: Substrate, load: FloatArray, area: FloatArray
) -> FloatArray | float:
    """Return the relative errors of A0 due to the finite size of contacts with loads and areas (m, n).

    An extra curvature of the summit by c reduces the area at fixed load by the fraction 2/3 c R, from Hertz's
    a^3 = 3 P R/4. For paraboloids an upper bound is returned if it is negligible.
    """
    own = abs(getattr(substrate, "self_curvature", 0.0))
    # at distances of at least r, the sum of (r/r_ij)^3 is largest on a hexagonal lattice, where it is 11.04
    densest = 11.04 / (2.0 * math.pi * nearest_distance(surface) ** 3)
    most = 2.0 / 3.0 * float((densest + own) * load.max()) * float(surface.radius.max())
    if law == PARABOLOID and most <= 1e-5:
        return most
    curvature = own * load + load @ near(surface, lambda r: 0.5 / (math.pi * r**3))
    _, response, _, _ = equivalent(law, surface, area)
    flatter = 2.0 / 3.0 * (curvature * response * area).sum(axis=1) / area.sum(axis=1)
    tilted = 0.0 if law == PARABOLOID else slope_effects(law, surface, area, substrate)[0]
    return np.asarray(flatter + tilted + truncation(surface, area, substrate, law))


def order_3_error(surface: Surface, area: FloatArray, substrate: Substrate, law: Contact) -> ModelError:
    """Return the largest error of A0 by order 3 for areas ([k,] n) [mm^2]; nan for laws of order 1."""
    if law.largest_order == 1:
        return ModelError(math.nan, unresolved(law))
    return largest(truncation(surface, area, substrate, law), RADII)


def unresolved(law: Contact) -> str:
    """Return why the error of a law of order 1 is unknown."""
    return f"contacts of {law} cannot be resolved"


def largest(errors: FloatArray, source: str, unsolved: str = "order 3 has no solution") -> ModelError:
    """Return the largest of the errors of a curve; nan with the reason if one is not finite."""
    worst = float(np.max(errors))
    if math.isfinite(worst):
        return ModelError(worst, source)
    return ModelError(math.nan, "contacts overlap" if math.isinf(worst) else unsolved)


def truncation(
    surface: Surface, area: FloatArray, substrate: Substrate, law: Contact = PARABOLOID
) -> FloatArray:
    """Return relative errors of A0 by order 3, ([k]), estimated from the contact areas ([k,] n) [mm^2].

    The first neglected terms are proportional to (a/r)^5 for the neighbours' fields, and to (a/t)^5 for the
    self terms of a layer. A source adds a curvature in proportion to p/r^3 = 4 a^3/(3 R r^3), whose effect is
    proportional to R of the affected contact. For laws other than Hertz's, equivalent radii replace both R,
    and the slope of the field changes the areas in proportion to the square of the slope, which is part of
    order 3, and to its fourth power. The error is infinite if contacts overlap.
    """
    bound, used = substrate.for_surface(surface), law.bound(surface)
    a, response, source, _ = equivalent(used, surface, area)
    strength, closed = a**5 / source, area > 0.0
    by_distance = near(surface, lambda r: r**-5.0)
    # On a 3 x 3 lattice, A0 differs from resolved contacts by up to .20 times the mean sum of (a/r)^5: by
    # .066 % at a sum of .0034, by .01 % at .0006. In a periodic cell the differences are .006, .033, .096,
    # .24 and .59 % at a/pitch = .13, .19, .23, .28 and .33, up to .32 times the sum.
    share = 0.2 if surface.cell is None else 0.32
    wide = area * (strength @ by_distance)
    # A small contact loses by the area of the source: for paraboloids .014 A_j R_i/R_j (a_j/r)^5, by the
    # first term of Hertz's displacement that order 3 omits. In a thousand random scenes A0 changed by up to
    # .037 times this sum, .05 is added; for equal contacts this is a quarter of the sum above.
    wide = share * (wide + 0.25 * closed * ((area * strength) @ by_distance))
    # On a layer with nu = .5, A0 differs by .12, .17, .63 and 1.7 % at a/t = .28, .3, .39 and .48, at most
    # .75 (a/t)^5, to which a quarter is added; with nu = .3 the difference is a third smaller.
    wide += 0.95 * area * strength / getattr(bound, "thickness", math.inf) ** 5
    error = (wide * response).sum(axis=-1) / _total(area)
    if used != PARABOLOID:
        # One resolved contact on a slope g differs by .4 to 1.3 times this effect, for power caps of powers 3
        # and 4 with g/D' of .15 and .3, quartic caps and spheres on 3 x 3 lattices by .6 to 1.0 times.
        error += 1.25 * slope_effects(used.without_adhesion, surface, area, bound)[1]
    if 2.0 * a.max() >= nearest_distance(surface):
        i, j, r = close_pairs(surface, 2.0 * float(a.max()))
        overlap = (a[..., i] + a[..., j] >= r) & closed[..., i] & closed[..., j]
        error = np.where(overlap.any(axis=-1), math.inf, error)
    return np.asarray(error)[()]


def near(surface: Surface, value: Callable[[FloatArray], FloatArray], axis: int | None = None) -> Any:
    """Return a sparse matrix of a function of the distances of the nearest sites, (n, n).

    axis: the matrix is multiplied by the cosine between this axis and the direction from row to column.
    """
    distance, other, apart = neighbours(surface)
    values = value(distance) if axis is None else value(distance) * apart[..., axis] / distance
    places = other.ravel(), np.repeat(np.arange(surface.count), other.shape[1])
    return scipy.sparse.csr_array((values.ravel(), places), shape=(surface.count, surface.count))


def equivalent(law: Contact, surface: Surface, area: FloatArray) -> tuple[FloatArray, ...]:
    """Return radii a, two radii of paraboloids equivalent to each contact [mm], and loads, ([k,] n) each.

    The first paraboloid has the same derivative of the area with respect to the indentation, the second the
    same load. Both radii are the summit radius for Hertz's law. Open contacts are given negligible radii.
    """
    summits = np.broadcast_to(law.summits(surface), area.shape)
    a = np.maximum(np.sqrt(area / math.pi), 1e-4 * sizes_of(summits))
    load = law.without_adhesion.load(a, summits)
    return a, law.area_slope(a, summits) / math.pi, 4.0 / 3.0 * a**3 / load, load


def slope_effects(
    law: Contact, surface: Surface, area: FloatArray, substrate: Substrate
) -> tuple[FloatArray, FloatArray]:
    """Return the relative changes of A0 by the slopes of the field in second order, and in the next one.

    The first change is part of order 3. The second one is that of ``1/sqrt(1 + 4 y)`` for the change -2 y of
    second order. Both are sums of absolute values; a contact loses at most its area.
    """
    a, _, _, load = equivalent(law, surface, area)
    field = substrate.for_surface(surface) if isinstance(substrate, Radial) else HalfSpace()
    along = (near(surface, lambda r: field.influence(r, derivatives=True)[1], axis) for axis in (0, 1))
    slope = np.hypot(*(load @ part for part in along))
    change = np.abs(area_change(law, a, np.broadcast_to(law.summits(surface), area.shape), slope))
    second, following = (np.minimum(part, 1.0) * area for part in (change, 1.5 * change**2))
    return second.sum(axis=-1) / _total(area), following.sum(axis=-1) / _total(area)


def _total(area: FloatArray) -> FloatArray:
    return np.asarray(np.maximum(area.sum(axis=-1), np.finfo(float).tiny))
