"""Contacts of a surface at one load, and at several loads of its law."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from metafem._validate import FloatArray
from metafem._values import MICROMETRES, three_digits
from metafem.errors import MetafemError
from metafem.explorer.law_data import numbers
from metafem.explorer.surface_data import at_sites
from metafem.inversion import Design
from metafem.models.curve import Curve
from metafem.models.model import contact_of
from metafem.prediction import ContactState, equilibrium
from metafem.progress import each

PERCENT = 100.0

# Millinewtons per newton.
MILLINEWTONS = 1e3

# Largest number of intervals between the loads, a power of two. On a straight line between two loads, the
# contact radii of the demo differ from the computed ones by at most 1 % of the largest, on a layer by 4 %.
INTERVALS = 32

# Largest number of values at the sites. Large surfaces have fewer loads, so that a message has at most 1 MB.
MOST_VALUES = 100_000

# Time after which no further load is computed [s]: contacts of a slow model are then those of fewer loads.
LONGEST = 2.0


def contact_data(design: Design, rescaled_load: float | None, sensitive: bool = False) -> dict[str, Any]:
    """Return the contacts under the model of the design at a load; default: the largest load of its law.

    The data contain the rescaled load [mm^2], the separation [um], and the contact radius [mm], the mean
    contact pressure [MPa] and the load [mN] at each site. If `sensitive`, they also contain the relative
    change of the friction force with each height [% per um]. If no contacts were found, they contain
    the load and the ``problem``.
    """
    modulus = design.surface.material.composite_modulus
    load = float(design.law.load[-1]) if rescaled_load is None else rescaled_load * modulus
    try:
        state = equilibrium(design.surface, design.law.model, load=load)
        found = _contacts(design, state)
        return found | (_sensitivity(design, load / modulus, state) if sensitive else {})
    except MetafemError as error:
        return {
            "load": load / modulus,
            "problem": f"At {three_digits(load)} N no contacts were found: {error}",
        }


def _contacts(design: Design, state: ContactState) -> dict[str, Any]:
    area, load = state.asperity_area, state.asperity_load
    closed = area > 0.0
    pressure = np.divide(load, area, out=np.zeros_like(load), where=closed)
    return {
        "load": state.load / design.surface.material.composite_modulus,
        "separation": MICROMETRES * state.separation,
        "radius": at_sites(design, np.sqrt(area / np.pi)),
        "pressure": at_sites(design, pressure),
        "force": at_sites(design, MILLINEWTONS * load),
    }


def _sensitivity(design: Design, rescaled_load: float, state: ContactState) -> dict[str, Any]:
    """Return the sensitivities 100 (dF/dh) / F [% per um] at the sites, and a note.

    A model without derivatives uses the derivatives of its `gradient_model`, which the note names.
    """
    model = design.law.model.gradient_model
    if not state.area > 0.0:
        return {"sensitivity": at_sites(design, np.zeros(design.surface.count)), "note": ""}
    found = model.sensitivity(design.surface, np.array([rescaled_load]))
    share = PERCENT * found.gradient[0] / (found.curve.area[0] * MICROMETRES)
    note = "" if model == design.law.model else f"Sensitivities are those of the model {model.name}."
    return {"sensitivity": at_sites(design, share), "note": note}


def press_data(design: Design) -> dict[str, Any]:
    """Return the contacts at loads from the smallest to the largest of the law, and the entry loads.

    ``states`` contain the rescaled load [mm^2], the separation [um], and the contact area [mm^2] and the load
    [mN] at each site. ``entry`` contains the rescaled load [mm^2] at which each site comes into contact, None
    if it is larger than the largest load; it is interpolated between the states unless ``exact``.
    """
    surface, model, law = design.surface, design.law.model, design.law
    curves = _curves(design)
    if not curves:
        return {"exact": False, "entry": [], "states": []}
    top, modulus = float(surface.height.max()), surface.material.composite_modulus
    adhesive = contact_of(model).bound(surface).adhesive
    exact = not (model.couples or adhesive)
    if exact:
        entry = np.full(surface.count, np.nan)
        reached = surface.gap < law.approach[-1]
        gap, row = np.unique(surface.gap[reached], return_inverse=True)
        entry[reached] = model.curve(surface, approach=gap).load[row]
    else:
        entry = _interpolated_entry(curves, None if adhesive else surface.height - top)
    loads = np.array([curve.load[0] for curve in curves])
    return {
        "exact": exact,
        "entry": at_sites(design, entry),
        "states": [
            {
                "load": load,
                "separation": MICROMETRES * (top - float(curve.approach[0])),
                "area": at_sites(design, curve.last.area),
                "force": at_sites(design, MILLINEWTONS * modulus * curve.last.load),
            }
            for load, curve in zip(numbers(loads), curves, strict=True)
        ],
    }


def _curves(design: Design) -> list[Curve]:
    """Return the converged equilibria at evenly spaced loads, in the order of the loads.

    The loads are computed from coarse to fine, so that those of a slow model are spread over the law.
    """
    intervals = INTERVALS
    while intervals > 1 and intervals * 2 * design.template.count > MOST_VALUES:
        intervals //= 2
    load = design.law.rescaled_load
    loads = np.linspace(load[0], load[-1], intervals + 1)
    found: dict[int, Curve] = {}
    start = time.monotonic()
    # k & -k is the largest power of two that divides k
    for k in each("pressing", sorted(range(intervals + 1), key=lambda k: k & -k or intervals, reverse=True)):
        if len(found) > 1 and time.monotonic() - start > LONGEST:
            break
        try:
            curve = design.law.model.curve(design.surface, loads[k : k + 1])
        except MetafemError:
            continue  # the states at the other loads are enough
        if curve.converged:
            found[k] = curve
    return [found[k] for k in sorted(found)]


def _interpolated_entry(curves: list[Curve], open_indentation: FloatArray | None) -> FloatArray:
    """Return the rescaled loads [mm^2] at which the indentations become positive, nan if they do not.

    `open_indentation` are the indentations at zero load; None if contacts form in jumps.
    """
    loads = np.array([curve.load[0] for curve in curves])
    depth = np.array([curve.last.indentation for curve in curves])
    closed = np.array([curve.last.area > 0.0 for curve in curves])
    if open_indentation is not None:
        loads, depth = np.append(0.0, loads), np.vstack([open_indentation, depth])
        closed = np.vstack([np.zeros_like(closed[:1]), closed])
    after, site = closed.argmax(axis=0), np.arange(closed.shape[1])
    before = np.maximum(after - 1, 0)
    low, high = depth[before, site], depth[after, site]
    share = np.divide(-low, high - low, out=np.ones_like(low), where=(low <= 0.0) & (high > 0.0))
    entry = loads[before] + share * (loads[after] - loads[before])
    return np.where(closed.any(axis=0), entry, np.nan)
