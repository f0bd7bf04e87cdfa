"""Compliance of the caps below the contacts, on the diagonal of the influence matrix."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from metafem.contact.cap_compliance import COEFFICIENTS, POWERS, TALLEST
from metafem.notes import Note
from metafem.surface import Surface

# Terms of the fit to finite elements that do not depend on the contact radius: coefficients of theta^2,
# theta^3, ... Terms that grow with the contact radius belong to the contact law and are left out; there small
# strain errs as much to one side as finite strain does to the other.
LIGHT = {i: c for c, (i, j) in zip(COEFFICIENTS, POWERS, strict=True) if j == 0}


def pedestal_influence(height: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Displacement of summits by their own caps, per unit of P/E* [1/mm], and its derivative by the height.

    ``c_p/pi`` of `metafem.contact.pedestal_compliance` in the limit of light loads. It vanishes in
    proportion to the height, so that caps lower than the table's lowest row follow the fit, and summits
    at or below the base plane have no pedestal. Summits taller than its last row keep that row's value.

    Examples
    --------
    >>> value, rate = pedestal_influence(np.array([0.12, 0.27]), np.array([0.526, 0.526]))
    >>> (math.pi * value).round(2)
    array([0.22, 0.61])
    """
    ratio = np.clip(height / radius, 0.0, TALLEST)
    angle = np.arccos(1.0 - ratio)
    value = sum(c * angle**i for i, c in LIGHT.items()) / (math.pi * radius)
    # d angle/dh = 1/(R sin(angle)), and angle/sin(angle) stays finite
    slope = sum(i * c * angle ** (i - 2) for i, c in LIGHT.items()) / np.sinc(angle / math.pi)
    within = (ratio > 0.0) & (ratio < TALLEST)
    return np.asarray(value), np.where(within, slope / (math.pi * radius**2), 0.0)


def pedestal_notes(surface: Surface) -> tuple[Note, ...]:
    """State how many summits are taller than the range of the table."""
    tall = int((surface.height > TALLEST * surface.radius).sum())
    if not tall:
        return ()
    return (Note(f"{tall} summits are higher than {TALLEST:g} R; their pedestals are taken as that high"),)
