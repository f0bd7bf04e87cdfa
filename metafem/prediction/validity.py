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
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy

from metafem._validate import FloatArray
from metafem._values import percent
from metafem.contact import Contact
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
from metafem.notes import Level, Note, information
from metafem.prediction.part_notes import part_notes
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

# Second moment of a uniform pressure over that of Hertz's pressure, 1/2 over 2/5.
UNIFORM = 1.25

# Relative tolerance of the approach at which paraboloids have the same area as the contacts of another law.
SIZE_TOLERANCE = 1e-6

# Remedy if a model finds no equilibrium.
REMEDY = "use lighter loads, a larger pitch or the model resolved"

# Name of the number of a note that the explorer reads.
BASE = "load at which the plane touches the base"

NOT_ESTIMATED = ModelError(math.nan, "it was not estimated with the law")

# Tolerance of the base gap at the load of base contact, relative to the largest height.
BASE_TOLERANCE = 1e-9

# Largest number of steps in the search for an approach at which the plane reaches the base. Each step at
# least doubles the excess of the approach over the largest height.
MOST_STEPS = 60


@dataclass(frozen=True, eq=False)
class Validity:
    """Estimated error of a curve of a model, and notes on the effects that the model neglects.

    `unloading` says whether the states of the curve are those on unloading from its largest load.
    """

    surface: Surface
    model: Model
    curve: Curve
    unloading: bool = False

    @cached_property
    def error(self) -> ModelError:
        """Estimated error of A0(P)."""
        return model_error(self.surface, self.model, self.curve, self.unloading)

    def notes(self, notes: tuple[Note, ...]) -> tuple[Note, ...]:
        """Return `notes`, followed by estimates of the effects that the model neglects."""
        surface, model, curve = self.surface, self.model, self.curve
        law = contact_of(model)
        return (
            *notes,
            *law.bound(surface).notes(curve.last.indentation, law.summits(surface)),
            *_base_notes(surface, model, curve),
            *_wide_notes(surface, model, curve),
            *_unusual_notes(surface, curve),
            *(self._interaction_notes() if (curve.load > 0.0).any() else ()),
            *part_notes(surface),
        )

    def _interaction_notes(self) -> Iterator[Note]:
        """Yield notes on the change of A0 by neighbours and block, and on the validity of order 3."""
        surface, model, law = self.surface, self.model, contact_of(self.model)
        error = self.error
        reference = reference_of(surface, model if model.couples else without_jumps(surface, model))
        if model.couples and model.reference != reference:
            error = self._change_by_block(reference)
        if error.load.size:
            yield from _change_notes(surface, model, reference, error)
        if not error.solved:
            unknown = "the effect of elastic interaction cannot be estimated over all loads"
            yield Note(f"{unknown}: {error.source}; use {_resolved_or(law)}lighter loads")
        if model == model.gradient_model:  # otherwise the contacts are resolved and may merge
            yield from _width_notes(surface, model, reference, self.curve)
        if model.couples and law.largest_order == 1:
            yield _size_note(surface, reference, law, float(self.curve.area[-1]))

    def _change_by_block(self, reference: Interacting) -> ModelError:
        """Return the difference of a model on a half-space from a reference model on the bonded layer."""
        surface, curve = self.surface, self.curve
        # for resolved contacts, order 3 is compared with order 3
        model = without_jumps(surface, self.model.gradient_model)
        if model != self.model:
            try:
                curve = model.curve(surface, curve.load[curve.load > 0.0]).checked()
            except MetafemError as reason:
                return ModelError(math.nan, str(reason), solved=False)
        return compared(surface, without_jumps(surface, reference), curve, self.unloading)


def _resolved_or(law: Contact) -> str:
    """Return the start of a remedy, "the model resolved, or ", if the contacts of the law can be resolved."""
    return "the model resolved, or " if resolvable(law) else ""


def _size_note(surface: Surface, reference: Interacting, law: Contact, area: float) -> Note:
    """Return a note on the error of point loads for other laws than elastic ones, by that of paraboloids."""
    point = Interacting(1, reference.substrate)

    def at(approach: float) -> Curve:
        return point.curve(surface, approach=np.array([approach])).checked()

    try:
        high = area / (math.pi * float(surface.radius.max()))  # the approach for one summit
        while at(high).area[0] <= area:
            high *= 2.0
        alike = scipy.optimize.brentq(lambda x: at(x).area[0] - area, 0.0, high, rtol=SIZE_TOLERANCE)
        larger = point.reference.curve(surface, at(alike).load).checked().area[0]
    except MetafemError as reason:
        return Note(f"what point loads leave out of the size of the contacts cannot be estimated: {reason}")
    return information(
        f"contacts of {law!r} are coupled as point loads: for paraboloids of the same "
        f"area the size of the contacts changes A0 by {percent(larger / area - 1.0, '+.2g')}, and by up to "
        f"{UNIFORM:g} times as much where the pressure is uniform"
    )


def _change_notes(
    surface: Surface, model: Model, reference: Interacting, error: ModelError
) -> Iterator[Note]:
    """Yield a note on the change of A0 at given load due to effects that the model neglects."""
    load, change = error.load, error.change
    rms = math.sqrt(float((change**2).mean()))
    if rms < STATED:
        return
    most = int(np.abs(change).argmax())
    what, who = "thickness of the block", "a half-space"
    if not model.couples:
        what, who = "elastic interaction of the asperities", "this model"
    elif model.reference == reference:
        what, who = "size of the contacts", "a point load"
    spread = f"by {percent(rms)} rms and " if load.size > 1 else ""
    text = (
        f"the {what}, which {who} leaves out, changes A0 at a given load {spread}by up to "
        f"{percent(change[most], '+.2g')}, at {surface.material.composite_modulus * load[most]:.4g} N "
        f"({rung_name(reference)})"
    )
    if rms > BOUND:
        better = "half-space" if reference.substrate == HalfSpace() else "layer"
        text += f"; use the model {better}, or a larger pitch"
    level = Level.WARNING if rms > BOUND else Level.INFORMATION
    yield Note(text, level, f"change of A0 by the {what}", rms, BOUND, ("model", "pitch"))


def _width_notes(surface: Surface, model: Model, reference: Interacting, curve: Curve) -> Iterator[Note]:
    """Yield notes on contacts that overlap, or that are wide relative to their distances or their layer."""
    law, area, newtons = contact_of(model), curve.last.area, _last_force(surface, curve)
    remedy = f"use {_resolved_or(law)}a larger pitch or lighter loads"
    if overlaps := overlapping_contacts(surface, area):
        pairs = "pair reaches" if overlaps == 1 else "pairs reach"
        text = f"contacts overlap: {overlaps} {pairs} into each other at {newtons:.4g} N, where real contacts"
        number = "overlapping pairs of contacts"
        yield Note(f"{text} merge; {remedy}", Level.WARNING, number, overlaps, 0.0, ("pitch",))
    elif law.largest_order == 3:
        error = float(truncation(surface, area, reference.substrate, law))
        text = (
            "the contacts are too wide for their distances or their layer: the error of order 3 may be "
            f"{percent(error)} in A0 at {newtons:.4g} N"
        )
        if error > BOUND:
            yield Note(
                f"{text}; {remedy}", Level.WARNING, "error of order 3", error, BOUND, ("model", "pitch")
            )
        elif error > STATED and model.couples:
            yield information(text.replace("too wide", "wide"))


def overlapping_contacts(surface: Surface, area: FloatArray) -> int:
    """Return the number of pairs of contacts with areas (n,) [mm^2] that overlap."""
    radius = np.sqrt(area / math.pi)
    i, j, distance = close_pairs(surface, 2.0 * float(radius.max()))
    return int(((radius[i] + radius[j] > distance) & (area[i] > 0.0) & (area[j] > 0.0)).sum())


def _last_force(surface: Surface, curve: Curve) -> float:
    """Return the last load of a curve [N]."""
    return surface.material.composite_modulus * float(curve.load[-1])


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


def _base_notes(surface: Surface, model: Model, curve: Curve) -> Iterator[Note]:
    """Yield a note on the load at which the plane would reach the base plane."""
    gap, newtons = curve.last.base_gap, _last_force(surface, curve)
    if gap > 0.0:
        return
    try:
        onset = min(surface.material.composite_modulus * base_contact_load(surface, model), newtons)
    except MetafemError:  # no solution at lighter loads: state the last load
        onset = newtons
    text = (
        f"the base plane would touch from a load of {onset:.4g} N on: at {newtons:.4g} N the plane would be "
        f"{-1e3 * gap:.3g} um below the base beside a summit; the load that the base would carry is not "
        "counted"
    )
    yield Note(text, quantity=BASE, value=onset, bound=newtons, remedies=("offset",))


def _wide_notes(surface: Surface, model: Model, curve: Curve) -> Iterator[Note]:
    """Yield a note on contacts that are too wide for small-strain models."""
    ratio = float((np.sqrt(curve.last.area / math.pi) / surface.radius).max())
    if ratio <= WIDEST:
        return
    range_of = f"the law of small strain was compared with soft spheres up to {WIDEST:g} only"
    if has_paraboloids(model):
        range_of = f"Hertz's law holds up to about {WIDEST:g}, with a fitted modulus"
    text = f"the widest contact has a/R = {ratio:.2f} at {_last_force(surface, curve):.4g} N: {range_of}"
    level = Level.WARNING if ratio > TOO_WIDE else Level.INFORMATION
    yield Note(text, level, "widest contact, a/R", ratio, WIDEST, ("radius",))


def _unusual_notes(surface: Surface, curve: Curve) -> Iterator[Note]:
    """Yield warnings of a modulus that no elastomer has, and of loads that hardly deform the caps."""
    modulus, (least, most) = surface.material.composite_modulus, ELASTOMERS
    if not least <= modulus <= most:
        text = f"E* = {modulus:.4g} MPa, but rubbers and gels have {least:g} to {most:g} MPa: check its unit"
        yield Note(text, quantity="composite modulus", value=modulus, remedies=("composite_modulus",))
    ratio = float((np.sqrt(curve.last.area / math.pi) / surface.radius).max())
    if len(curve.load) > 1 and 0.0 < ratio < NARROWEST:
        yield Note(
            f"even at the largest load, {_last_force(surface, curve):.4g} N, the widest contact has only "
            f"a/R = {ratio:.1g}: check the units of loads and modulus",
            quantity="widest contact, a/R",
            value=ratio,
            bound=NARROWEST,
            remedies=("load", "composite_modulus"),
        )
