"""Hertz's law for kernels, for unit E*; see `metafem.contact.elastic`."""

from __future__ import annotations

import math

from metafem._kernels.compiled import compiled

# P = LOAD a d and dP/dd = STIFFNESS a. Sums over contacts are multiplied by these factors once, at the end.
LOAD = 4.0 / 3.0
STIFFNESS = 2.0


@compiled
def contact_radius(radius, indentation):
    """Return a = sqrt(R d) [mm]."""
    return math.sqrt(radius * indentation)


@compiled
def indentation_at_load(radius, load):
    """Return d = (3/4 P/sqrt(R))^(2/3) [mm]."""
    return (load / (LOAD * math.sqrt(radius))) ** (2.0 / 3.0)
