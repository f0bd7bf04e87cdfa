"""Estimated error of a result, and notes on the effects that its model neglects.

The change of A0 by neglected effects is that of `models.error`. It is compared with a reference model
at a few loads, because a sum over the neighbours is not accurate enough: uniform sinking does not change
A0(P), the remaining change may have either sign, and the sum is wrong by a factor of ten if contacts are
crowded. Order 3 estimates the change by resolved contacts within a factor of two, even if contacts overlap or
are as wide as the layer is thick. The true block differs from the layer by less than 0.4 % in A0, but its
influence takes a minute to compute, so the layer is used.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import cache, partial
from typing import Any

import numpy as np
import scipy

from metafem._validate import FloatArray
from metafem._values import MICROMETRES, percent
from metafem.caps import SPHERE
from metafem.errors import MetafemError
from metafem.material import ELASTOMERS
from metafem.models import Curve, Interacting, Model
from metafem.models.boundary_elements.model import resolvable
from metafem.models.curve import ModelError
from metafem.models.error import (
    compared,
    model_error,
    reference_of,
    rung_name,
    truncation,
    without_jumps,
)
from metafem.models.interacting.influence import close_pairs
from metafem.models.model import contact_of, has_paraboloids
from metafem.notes import Level, Note, information, when_read
from metafem.substrate import HalfSpace
from metafem.surface import Surface

# Relative error of A0 at given load, rms over the loads, above which a note is a warning. The interaction
# error of the surfaces of the source paper is 0.4 to 3.3 % for any assignment of heights to sites, and the
# paper regards these surfaces as successful. With an error of 5 % every design needs a warning. The rms over
# the probed loads differs from that over a hundred loads by less than a fifth, which is less than the margin
# between BOUND and these two values.
BOUND = 0.04

# Smallest error for which there is an information note.
STATED = 0.01

# Bounds of the contact radius over the radius of curvature: above WIDEST there is an information note, above
# TOO_WIDE a warning. For a soft cap at large strain, the load of Hertz's law with a fitted modulus has an
# error of 2 % at a/R = 0.5; WIDEST is 10 % higher. An error of BOUND in A0 corresponds to 6 % in the load. If
# the error grows as (a/R)^4, it reaches 6 % at 1.3 times 0.5.
WIDEST, TOO_WIDE = 0.55, 0.65

# Smallest a/R of the widest contact at the largest load of a law; below it the loads are suspected. Those of
# the source paper's surfaces exceed 0.3, and loads a thousand times smaller make contacts ten times smaller.
NARROWEST = 0.1

# Remedy if a model finds no equilibrium.
REMEDY = "use lighter loads, a larger pitch or the model resolved"

# Name of the number of a note that the explorer reads.
BASE = "load at which the glass touches the base"

NOT_ESTIMATED = ModelError(math.nan, "it was not estimated with the law")

# Tolerance of the base gap at the load of base contact, relative to the largest height.
BASE_TOLERANCE = 1e-9

# Largest number of steps in the search for an approach at which the plane reaches the base. Each step at
# least doubles the excess of the approach over the largest height.
MOST_STEPS = 60


def judged(
    surface: Surface, model: Model, curve: Curve, notes: tuple[Note, ...], unloading: bool = False
) -> dict[str, Any]:
    """Return the notes and the estimated error of a result, which are computed when they are read.

    `unloading` says whether the states of the curve are those on unloading from its largest load.
    """
    size = surface.count + curve.area.size
    error = cache(partial(model_error, surface, model, curve, unloading))
    later = when_read(_notes, surface, model, curve, notes, error, unloading, size=size)
    return {"notes": later if curve.converged else notes, "model_error": when_read(error, size=size)}


def _notes(
    surface: Surface,
    model: Model,
    curve: Curve,
    notes: tuple[Note, ...],
    error: Callable[[], ModelError],
    unloading: bool,
) -> tuple[Note, ...]:
    """Return `notes`, followed by estimates of the effects that the model neglects."""
    law, last = contact_of(model), curve.last
    newtons = surface.material.composite_modulus * float(curve.load[-1])
    return (
        *notes,
        *law.bound(surface).notes(last.indentation, law.summits(surface)),
        *_base_notes(surface, model, last.base_gap, newtons),
        *_size_notes(surface, model, curve, newtons),
        *(_interaction_notes(surface, model, curve, error, unloading) if (curve.load > 0.0).any() else ()),
        *(_width_notes(surface, model, last.area, newtons) if model == model.gradient_model else ()),
        *_part_notes(surface),
    )


def _above(
    text: str, quantity: str, value: float, stated: float, bound: float, remedy: str, *arguments: str
) -> Iterator[Note]:
    """Yield a note on a number above `stated`; above `bound` it is a warning, which ends with the remedy."""
    if value > bound:
        yield Note(f"{text}{remedy}", Level.WARNING, quantity, value, bound, arguments)
    elif value > stated:
        yield Note(text, Level.INFORMATION, quantity, value, bound, arguments)


def _base_notes(surface: Surface, model: Model, gap: float, newtons: float) -> Iterator[Note]:
    """Yield a note on the load at which the plane would reach the base plane."""
    if gap > 0.0:
        return
    try:
        onset = min(surface.material.composite_modulus * base_contact_load(surface, model), newtons)
    except MetafemError:  # no solution at lighter loads: state the last load
        onset = newtons
    text = (
        f"the base plane would touch from a load of {onset:.4g} N on: at {newtons:.4g} N the glass would be "
        f"{-MICROMETRES * gap:.3g} um below the base beside a summit; the load that the base would carry is "
        "not counted"
    )
    yield Note(text, quantity=BASE, value=onset, bound=newtons, remedies=("offset",))


def _size_notes(surface: Surface, model: Model, curve: Curve, newtons: float) -> Iterator[Note]:
    """Yield notes on contacts too wide for small strain or suspiciously narrow, and on a strange modulus."""
    ratio = float((np.sqrt(curve.last.area / math.pi) / surface.radius).max())
    range_of = f"the law of small strain was compared with soft spheres up to {WIDEST:g} only"
    if has_paraboloids(model):
        range_of = f"Hertz's law holds up to about {WIDEST:g}, with a fitted modulus"
    text = f"the widest contact has a/R = {ratio:.2f} at {newtons:.4g} N: {range_of}"
    yield from _above(text, "widest contact, a/R", ratio, WIDEST, TOO_WIDE, "", "radius")
    modulus, (least, most) = surface.material.composite_modulus, ELASTOMERS
    if not least <= modulus <= most:
        text = f"E* = {modulus:.4g} MPa, but rubbers and gels have {least:g} to {most:g} MPa: check its unit"
        yield Note(text, quantity="composite modulus", value=modulus, remedies=("composite_modulus",))
    if len(curve.load) > 1 and 0.0 < ratio < NARROWEST:
        text = (
            f"even at the largest load, {newtons:.4g} N, the widest contact has only a/R = {ratio:.1g}: "
            "check the units of loads and modulus"
        )
        remedies = "load", "composite_modulus"
        yield Note(text, Level.WARNING, "widest contact, a/R", ratio, NARROWEST, remedies)


def _interaction_notes(
    surface: Surface, model: Model, curve: Curve, error: Callable[[], ModelError], unloading: bool
) -> Iterator[Note]:
    """Yield notes on the change of A0 at given load by neighbours and block, which the model leaves out."""
    reference = reference_of(surface, model if model.couples else without_jumps(surface, model))
    what, who = "elastic interaction of the asperities", "this model"
    found = error()
    if model.couples:
        what, who = "size of the contacts", "a point load"
        if model.reference != reference:
            what, who = "thickness of the block", "a half-space"
            found = _change_by_block(surface, model, reference, curve, unloading)
    if found.load.size:
        load, change = found.load, found.change
        rms, most = math.sqrt(float((change**2).mean())), int(np.abs(change).argmax())
        spread = f"by {percent(rms)} rms and " if load.size > 1 else ""
        text = (
            f"the {what}, which {who} leaves out, changes A0 at a given load {spread}by up to "
            f"{percent(change[most], '+.2g')}, at {surface.material.composite_modulus * load[most]:.4g} N "
            f"({rung_name(reference)})"
        )
        better = "half-space" if reference.substrate == HalfSpace() else "layer"
        remedy = f"; use the model {better}, or a larger pitch"
        yield from _above(text, f"change of A0 by the {what}", rms, STATED, BOUND, remedy, "model", "pitch")
    if not found.solved:
        unknown = "the effect of elastic interaction cannot be estimated over all loads"
        yield Note(f"{unknown}: {found.source}; use {_resolved_or(model)}lighter loads")


def _change_by_block(
    surface: Surface, model: Model, reference: Interacting, curve: Curve, unloading: bool
) -> ModelError:
    """Return the difference of a model on a half-space from a reference model on the bonded layer."""
    # for resolved contacts, order 3 is compared with order 3
    used = without_jumps(surface, model.gradient_model)
    if used != model:
        try:
            curve = used.curve(surface, curve.load[curve.load > 0.0]).checked()
        except MetafemError as reason:
            return ModelError(math.nan, str(reason), solved=False)
    return compared(surface, without_jumps(surface, reference), curve, unloading)


def _resolved_or(model: Model) -> str:
    """Return the start of a remedy, "the model resolved, or ", if the contacts can be resolved."""
    return "the model resolved, or " if resolvable(contact_of(model)) else ""


def _width_notes(surface: Surface, model: Model, area: FloatArray, newtons: float) -> Iterator[Note]:
    """Yield a note on contacts (n,) [mm^2] that overlap, or that are wide for order 3."""
    law, reference = contact_of(model), reference_of(surface, model)
    remedy = f"; use {_resolved_or(model)}a larger pitch or lighter loads"
    radius = np.sqrt(area / math.pi)
    pairs = _overlaps(surface, np.where(area > 0.0, radius, -math.inf))
    reach = "pair reaches" if pairs == 1 else "pairs reach"
    text = f"contacts overlap: {pairs} {reach} into each other at {newtons:.4g} N, where real contacts merge"
    yield from _above(text, "overlapping pairs of contacts", pairs, 0, 0, remedy, "pitch")
    if not pairs and law.largest_order == 3:
        error = float(truncation(surface, area, reference.substrate, law))
        text = (
            "the contacts are wide for their distances or their layer: the error of order 3 may be "
            f"{percent(error)} in A0 at {newtons:.4g} N"
        )
        stated = STATED if model.couples else BOUND
        yield from _above(text, "error of order 3", error, stated, BOUND, remedy, "model", "pitch")


def _overlaps(surface: Surface, radius: FloatArray) -> int:
    """Return the number of pairs of circles (n,) [mm] around the sites that overlap, in all periods."""
    i, j, distance = close_pairs(surface, 2.0 * float(radius.max(initial=0.0)))
    return int((distance < radius[i] + radius[j]).sum())


def _part_notes(surface: Surface) -> Iterator[Note]:
    """Yield notes on features of the surface that cannot be manufactured or differ in the part."""
    height, radius, block, count = surface.height, surface.radius, surface.block, surface.count
    tallest = surface.cap.tallest(radius)
    foot = surface.cap.foot_radius(np.clip(height, 0.0, tallest), radius)
    low, high, pairs = int((height < 0.0).sum()), int((height > tallest).sum()), _overlaps(surface, foot)
    text = (
        f"{low} of {count} summits lie below the base plane, the lowest at {height.min():.4g} mm, and cannot "
        "be made as caps: raise them above 0 mm"
    )
    yield from _above(text, "summits below the base plane", low, 0, 0, "", "min_height")
    limit, wider = "their profile is deep", "give a wider profile"
    if surface.cap == SPHERE:
        limit, wider = "their radius", "use larger radii"
    text = (
        f"{high} of {count} summits stand higher than {limit} and cannot be made as caps: lower them to "
        f"{float(tallest.min()):.4g} mm, or {wider}"
    )
    yield from _above(text, "summits too high for caps", high, 0, 0, "", "max_height", "radius")
    text = (
        f"the caps of {pairs} {'pair' if pairs == 1 else 'pairs'} of summits overlap on the base plane and "
        "cannot be made as separate caps: increase the pitch, or lower the summits"
    )
    yield from _above(text, "overlapping pairs of caps", pairs, 0, 0, "", "pitch")
    if block is None:
        return
    outside = int((2.0 * np.abs(surface.position) > [block.width, block.length]).any(axis=1).sum())
    text = (
        f"{outside} of {count} summits stand outside the block of {block.width:g} by {block.length:g} mm, "
        "whose centre is at (0, 0): make it larger, or move them"
    )
    yield from _above(text, "summits outside the block", outside, 0, 0, "", "width", "length")
    if surface.cell is not None:
        period = f"the part has one period of {surface.cell.width:g} by {surface.cell.length:g} mm"
        yield information(f"the law is that of an infinite surface; {period}")


def base_contact_load(surface: Surface, model: Model) -> float:
    """Return the rescaled load [mm^2] at which the plane reaches the sunken base near a summit.

    The base gap of `ContactState` is zero at this load. For the resolved model, order 3 is solved instead.
    Raise NotConverged or InvalidInput if the model has no solution at such a load.
    """
    top = float(surface.height.max())
    if top <= 0.0:
        return 0.0

    def at(approach: float) -> Curve:
        return model.gradient_model.curve(surface, approach=np.array([approach])).checked()

    def gap(approach: float) -> float:
        return at(approach).last.base_gap

    if gap(0.0) <= 0.0:  # strong adhesion pulls the base to the plane at the first contact
        return 0.0
    # start from the base contact of independent asperities; it comes later if the base sinks, and it may come
    # earlier if the layer rises
    high, small = top, BASE_TOLERANCE * top
    for _ in range(MOST_STEPS):
        if gap(high) <= small:
            break
        high += max(2.0 * gap(high), high - top)  # doubles the step if the base sinks almost as far
    if abs(gap(high)) > small:
        high = scipy.optimize.brentq(gap, 0.0, high, xtol=small)
    return float(at(high).load[0])
