"""Errors of order 3, estimated from the contact radii."""

from __future__ import annotations

import math

import numpy as np

from metafem._validate import FloatArray
from metafem.substrate import Substrate
from metafem.surface import Surface

# Relative error of A0 by order 3 per sum of (a/r)^5: on a 3 x 3 lattice resolved contacts differ by up to
# 0.20 of the mean sum (0.066 % at 0.0034, 0.01 % at 0.0006); a quarter is added for safety.
PAIRS = 0.25

# The same per (a/t)^5 of a contact on a layer: resolved contacts differ by 0.12, 0.5 and 1.5 % at a/t = 0.3,
# 0.4 and 0.5 with nu = 0.5 (0.9 % at 0.5 with nu = 0.3).
LAYER = 0.5

# Largest number of asperities for which all pairs are summed, and the number of nearest neighbours that are
# counted above: on a lattice those farther away add less than a hundredth.
ALL_PAIRS, NEIGHBOURS = 256, 24

# Contact radius over distance of neighbours up to which order 3 was compared with resolved contacts.
COMPARED = 0.32


def truncation(surface: Surface, area: FloatArray, substrate: Substrate) -> float:
    """Return the relative error of A0 by order 3, estimated from the contact areas (n,) [mm^2].

    The next terms of the neighbours' fields fall as (a/r)^5, and those of a layer's own as (a/t)^5; the
    curvature by a source is p/r^3 = 4 a^3/(3 R r^3), whose effect is proportional to the R of the contact.
    Infinite where contacts overlap.
    """
    from metafem._kernels.truncation import pair_sum

    thickness = getattr(substrate.for_surface(surface), "thickness", None)
    error = 0.0
    if thickness is not None and area.any():
        error = LAYER * float(area @ (np.sqrt(area / math.pi) / thickness) ** 5 / area.sum())
    if surface.count <= ALL_PAIRS:
        return error + PAIRS * float(pair_sum(surface.position, surface.radius, area))
    return error + PAIRS * _nearest_pairs(surface, area)


def _nearest_pairs(surface: Surface, area: FloatArray) -> float:
    """Return the sum of `pair_sum` over the nearest neighbours."""
    from scipy.spatial import cKDTree

    from metafem._kernels.truncation import SMALL

    closed = np.flatnonzero(area > 0.0)
    if closed.size < 2:
        return 0.0
    contact_radius, radius = np.sqrt(area[closed] / math.pi), surface.radius[closed]
    position = surface.position[closed]
    distance, other = cKDTree(position).query(position, k=min(NEIGHBOURS + 1, closed.size))
    distance, other = distance[:, 1:], other[:, 1:]
    if (contact_radius[:, None] + contact_radius[other] >= distance).any():
        return math.inf
    terms = (contact_radius[other] / distance) ** 5 * radius[:, None] / radius[other]
    weights = np.maximum(area[closed, None], SMALL * area[closed][other])
    return float((weights * terms).sum() / area[closed].sum())


def crowding(surface: Surface, contact_radius: FloatArray) -> tuple[int, float]:
    """Return how many pairs of contacts overlap, and the largest contact radius over their distance."""
    from scipy.spatial import cKDTree

    closed = np.flatnonzero(contact_radius > 0.0)
    if closed.size < 2:
        return 0, 0.0
    a = contact_radius[closed]
    # the field of j bends i by p_j R_i/r^3, (a_j/r)^3 R_i/R_j: a sharp summit counts as a wider one
    blunt = np.cbrt(surface.radius[closed])
    sharp = a / blunt
    # pairs beyond this distance neither overlap nor exceed the ratio
    reach = float((sharp * blunt.max()).max()) * max(2.0, 1.0 / COMPARED)
    tree = cKDTree(surface.position[closed])
    i, j = tree.query_pairs(reach, output_type="ndarray").T
    if not i.size:
        return 0, 0.0
    r = np.hypot(*(tree.data[i] - tree.data[j]).T)
    bending = np.maximum(sharp[j] * blunt[i], sharp[i] * blunt[j])
    return int((a[i] + a[j] > r).sum()), float((np.maximum(np.maximum(a[i], a[j]), bending) / r).max())
