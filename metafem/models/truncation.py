"""Errors of order 3, estimated from the contact radii."""

from __future__ import annotations

import math

import numpy as np
import scipy

from metafem._kernels.truncation import SMALL, pair_sum
from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import area_change
from metafem.models.interacting.influence import coupling_between
from metafem.models.interacting.model import DENSE_LIMIT
from metafem.substrate import Substrate
from metafem.surface import Surface

# Relative error of A0 by order 3, per sum of (a/r)^5. On a 3 x 3 lattice, resolved contacts differ by up to
# 0.20 of the mean sum (0.066 % at 0.0034, 0.01 % at 0.0006); a quarter is added for safety.
PAIRS = 0.25

# The same per (a/t)^5 of a contact on a layer: resolved contacts differ by 0.12, 0.17, 0.63 and 1.7 % at
# a/t = 0.28, 0.3, 0.39 and 0.48 with nu = 0.5, up to 0.75 of the power, and by two thirds of that with
# nu = 0.3; a quarter is added for safety.
LAYER = 0.95

# The effect of the slopes of the neighbours' fields on the area is known to second order. Together with the
# pair sum it is 0.8 to 1.3 times the difference from resolved contacts for powers 3 and 4 and for spheres, on
# 3 x 3 lattices and in irregular scenes with a/r from 0.2 to 0.32. A quarter is added for safety.
SLOPES = 1.25

# Largest number of asperities for which all pairs are summed; above it, number of nearest neighbours that
# are summed. On a lattice those farther away add less than a hundredth.
ALL_PAIRS, NEIGHBOURS = 256, 24

# Contact radius over R that replaces zero for open contacts.
SMALLEST = 1e-3

# Contact radius over distance of neighbours up to which order 3 was compared with resolved contacts.
COMPARED = 0.32

# Contact radius over thickness of a layer up to which the error of order 3 is at most 0.2 %.
COMPARED_ON_LAYER = 0.3


def truncation(surface: Surface, area: FloatArray, substrate: Substrate, law: Contact = PARABOLOID) -> float:
    """Return the relative error of A0 by order 3, estimated from the contact areas (n,) [mm^2].

    The next terms of the neighbours' fields fall as (a/r)^5, and the self terms of a layer as (a/t)^5. The
    curvature by a source is p/r^3 = 4 a^3/(3 R r^3); its effect is proportional to R of the affected contact.
    For laws other than Hertz's, equivalent radii replace both R, and the slope of the field changes the areas
    in proportion to the square of the slope. Infinite if contacts overlap.
    """
    if not area.any():
        return 0.0
    bound = substrate.for_surface(surface)
    used = law.for_material(surface.material)
    response, source = equivalent_radii(used, surface, area)
    thickness = getattr(bound, "thickness", None)
    error = 0.0
    if thickness is not None:
        wide = (np.sqrt(area / math.pi) / thickness) ** 5 * response / source
        error = LAYER * float(area @ wide / area.sum())
    if used != PARABOLOID:
        error += SLOPES * _tilt(used.without_adhesion, surface, area, bound)
    if surface.count <= ALL_PAIRS:
        return error + PAIRS * float(pair_sum(surface.position, response, source, area))
    return error + PAIRS * _nearest_pairs(surface, response, source, area)


def equivalent_radii(law: Contact, surface: Surface, area: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return two radii [mm] of paraboloids equivalent to each contact, (n,).

    The first gives the same increase of area with indentation, the second the same load. Both are the summit
    radius for Hertz's law and for open contacts.
    """
    radius = np.array(np.broadcast_to(surface.radius, area.shape))
    if law == PARABOLOID:
        return radius, radius
    closed = area > 0.0
    a = np.where(closed, np.sqrt(area / math.pi), radius * SMALLEST)
    response = law.area_slope(a, radius) / math.pi
    source = 4.0 / 3.0 * a**3 / law.without_adhesion.load(a, radius)
    return np.where(closed, response, radius), np.where(closed, source, radius)


def _tilt(law: Contact, surface: Surface, area: FloatArray, substrate: Substrate) -> float:
    """Return the relative change of A0 by the slopes of the field, at most that of removing the contacts."""
    closed = np.flatnonzero(area > 0.0)
    a, radius = np.sqrt(area[closed] / math.pi), np.broadcast_to(surface.radius, area.shape)[closed]
    load = np.zeros(area.shape)
    load[closed] = law.load(a, radius)
    if surface.count <= DENSE_LIMIT:
        coupling, _ = coupling_between(surface, substrate, 3)
        slope = np.hypot(coupling.slope_x @ load, coupling.slope_y @ load)[closed]
    else:
        slope = _nearest_slopes(surface.position[closed], load[closed])
    change = np.minimum(np.abs(area_change(law, a, radius, slope)), 1.0)
    return float(change @ area[closed] / area.sum())


def _nearest_slopes(position: FloatArray, load: FloatArray) -> FloatArray:
    """Return the slopes of the fields of the nearest neighbours on a half-space, (n,) [-]."""
    _, other = scipy.spatial.cKDTree(position).query(position, k=min(NEIGHBOURS + 1, len(load)))
    apart = position[:, None] - position[other[:, 1:]]
    distance = np.linalg.norm(apart, axis=-1)
    field = load[other[:, 1:]] / (math.pi * distance**3)
    return np.asarray(np.linalg.norm((field[..., None] * apart).sum(axis=1), axis=-1))


def _nearest_pairs(surface: Surface, response: FloatArray, source: FloatArray, area: FloatArray) -> float:
    """Return the sum of `pair_sum` over the nearest neighbours."""
    closed = np.flatnonzero(area > 0.0)
    if closed.size < 2:
        return 0.0
    contact_radius, response, source = np.sqrt(area[closed] / math.pi), response[closed], source[closed]
    position = surface.position[closed]
    distance, other = scipy.spatial.cKDTree(position).query(position, k=min(NEIGHBOURS + 1, closed.size))
    distance, other = distance[:, 1:], other[:, 1:]
    if (contact_radius[:, None] + contact_radius[other] >= distance).any():
        return math.inf
    terms = (contact_radius[other] / distance) ** 5 * response[:, None] / source[other]
    weights = np.maximum(area[closed, None], SMALL * area[closed][other])
    return float((weights * terms).sum() / area[closed].sum())


def crowding(surface: Surface, area: FloatArray, law: Contact = PARABOLOID) -> tuple[int, float]:
    """Return the number of overlapping pairs, and the largest ratio of contact radius to distance.

    area: (n,) [mm^2].
    """
    closed = np.flatnonzero(area > 0.0)
    if closed.size < 2:
        return 0, 0.0
    a = np.sqrt(area / math.pi)[closed]
    # the field of j changes the curvature of i by p_j r_i/r^3, (a_j/r)^3 r_i/s_j: sharp j count as wider
    response, source = (
        radii[closed] for radii in equivalent_radii(law.for_material(surface.material), surface, area)
    )
    blunt, sharp = np.cbrt(response), a / np.cbrt(source)
    # pairs beyond this distance neither overlap nor exceed the ratio
    reach = max(2.0 * float(a.max()), float(sharp.max() * blunt.max()) * max(2.0, 1.0 / COMPARED))
    tree = scipy.spatial.cKDTree(surface.position[closed])
    i, j = tree.query_pairs(reach, output_type="ndarray").T
    if not i.size:
        return 0, 0.0
    r = np.hypot(*(tree.data[i] - tree.data[j]).T)
    bending = np.maximum(sharp[j] * blunt[i], sharp[i] * blunt[j])
    return int((a[i] + a[j] > r).sum()), float((np.maximum(np.maximum(a[i], a[j]), bending) / r).max())
