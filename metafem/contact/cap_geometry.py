"""Geometry of spherical caps."""

from __future__ import annotations

import numpy as np

from metafem._validate import FloatArray
from metafem.contact.law import Values


def foot_radius(height: Values, radius: Values) -> FloatArray:
    """Radius of the circle in which a cap of height h <= R meets its base plane, sqrt(h (2 R - h)) [mm]."""
    return np.asarray(np.sqrt(height * (2.0 * radius - height)))


def sphere_profile(r: FloatArray, radius: Values) -> FloatArray:
    """Depth R - sqrt(R^2 - r^2) of a sphere below its summit at radii r <= R [mm], without cancellation."""
    return np.asarray(r**2 / (radius + np.sqrt((radius - r) * (radius + r))))
