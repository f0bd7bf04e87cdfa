"""Contacts of a surface at one load, and the sensitivity of the friction at this load to each height."""

from __future__ import annotations

from typing import Any

import numpy as np

from metafem._values import MICROMETRES, three_digits
from metafem.errors import MetafemError
from metafem.explorer.surface.surface_data import at_sites
from metafem.inversion import Design
from metafem.prediction import ContactState, equilibrium
from metafem.prediction.contact_state import MILLINEWTONS

PERCENT = 100.0

# Decimals of contact radii [mm], pressures [MPa], loads [mN] and sensitivities [% per um].
RADIUS_DECIMALS, PRESSURE_DECIMALS, LOAD_DECIMALS, SENSITIVITY_DECIMALS = 4, 5, 3, 5


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
        "radius": at_sites(design, np.sqrt(area / np.pi), RADIUS_DECIMALS),
        "pressure": at_sites(design, pressure, PRESSURE_DECIMALS),
        "force": at_sites(design, MILLINEWTONS * load, LOAD_DECIMALS),
    }


def _sensitivity(design: Design, rescaled_load: float, state: ContactState) -> dict[str, Any]:
    """Return the sensitivities 100 (dF/dh) / F [% per um] at the sites, and a note.

    A model without derivatives uses the derivatives of its `gradient_model`, which the note names.
    """
    model = design.law.model.gradient_model
    if not state.area > 0.0:
        return {"sensitivity": at_sites(design, np.zeros(design.surface.count), 0), "note": ""}
    found = model.sensitivity(design.surface, np.array([rescaled_load]))
    share = PERCENT * found.gradient[0] / (found.curve.rescaled_friction[0] * MICROMETRES)
    note = "" if model == design.law.model else f"Sensitivities are those of the model {model.name}."
    return {"sensitivity": at_sites(design, share, SENSITIVITY_DECIMALS), "note": note}
