"""Truncation errors of order 3, estimated from the contact radii."""

from __future__ import annotations

import math

import numpy as np

from metafem._kernels.truncation import SMALL, pair_sum
from metafem._validate import FloatArray, IntArray
from metafem.contact import Contact
from metafem.contact.elastic import PARABOLOID
from metafem.contact.law import area_change, sizes_of
from metafem.material import PeriodicCell
from metafem.models.interacting.influence import coupling_between
from metafem.models.interacting.model import DENSE_LIMIT
from metafem.models.neighbours import NEIGHBOURS, close_pairs, neighbours
from metafem.substrate import Substrate
from metafem.surface import Surface

# Relative error of A0 by order 3, divided by the sum of (a/r)^5. On a 3 x 3 lattice, A0 differs from resolved
# contacts by up to 0.20 times the mean sum: by 0.066 % at a sum of 0.0034, by 0.01 % at 0.0006. A quarter is
# added for safety.
PAIRS = 0.25

# The same in a periodic cell: on a square lattice, A0 differs from resolved contacts by 0.006, 0.033, 0.096,
# 0.24 and 0.59 % at a/pitch = 0.13, 0.19, 0.23, 0.28 and 0.33, up to 0.32 times the sum. A quarter is added.
PAIRS_IN_CELL = 0.4

# Relative error of A0 by order 3 on a layer, divided by (a/t)^5. With nu = 0.5, A0 differs from resolved
# contacts by 0.12, 0.17, 0.63 and 1.7 % at a/t = 0.28, 0.3, 0.39 and 0.48, which is at most 0.75 (a/t)^5.
# With nu = 0.3 the difference is a third smaller. A quarter is added for safety.
LAYER = 0.95

# Safety factor of the effect of the slopes of the neighbours' fields on the areas, beyond second order. One
# resolved contact on a slope g differs from order 3 by 0.4 to 1.3 times this effect, for power caps of powers
# 3 and 4 with g/D' of 0.15 and 0.3. The pair sum is 1.0 to 1.8 times the difference of quartic caps and
# spheres on 3 x 3 lattices with a/r from 0.2 to 0.35.
SLOPES = 1.25

# Largest number of asperities for which all pairs are summed; for more asperities, and in a periodic cell,
# only the nearest neighbours are.
ALL_PAIRS = 256

# Contact radius, divided by R, that open contacts are given to avoid division by zero.
SMALLEST = 1e-3

# Largest ratio of contact radius to the distance of neighbours at which order 3 was compared with resolved
# contacts.
COMPARED = 0.32

# Largest ratio of contact radius to layer thickness at which the error of order 3 is at most 0.2 %.
COMPARED_ON_LAYER = 0.3


def truncation(surface: Surface, area: FloatArray, substrate: Substrate, law: Contact = PARABOLOID) -> float:
    """Return the relative error of A0 by order 3, estimated from the contact areas (n,) [mm^2].

    The first neglected terms are proportional to (a/r)^5 for the neighbours' fields, and to (a/t)^5 for the
    self terms of a layer. A source adds a curvature in proportion to p/r^3 = 4 a^3/(3 R r^3), whose effect is
    proportional to R of the affected contact. For laws other than Hertz's, equivalent radii replace both R,
    and the slope of the field changes the areas in proportion to the square of the slope, which is part of
    order 3, and to its fourth power. The error is infinite if contacts overlap.
    """
    if not area.any():
        return 0.0
    bound = substrate.for_surface(surface)
    used = law.bound(surface)
    response, source = equivalent_radii(used, surface, area)
    thickness = getattr(bound, "thickness", None)
    error = 0.0
    if thickness is not None:
        wide = (np.sqrt(area / math.pi) / thickness) ** 5 * response / source
        error = LAYER * float(area @ wide / area.sum())
    if used != PARABOLOID:
        error += SLOPES * slope_effects(used.without_adhesion, surface, area, bound)[1]
    if surface.count <= ALL_PAIRS and surface.cell is None:
        return error + PAIRS * float(pair_sum(surface.position, response, source, area))
    share = PAIRS if surface.cell is None else PAIRS_IN_CELL
    return error + share * _nearest_pairs(surface, response, source, area)


def equivalent_radii(law: Contact, surface: Surface, area: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return two radii [mm] of paraboloids equivalent to each contact, (n,).

    The first paraboloid has the same derivative of the area with respect to the indentation, the second the
    same load. Both radii are the summit radius for Hertz's law and for open contacts.
    """
    summits = np.broadcast_to(law.summits(surface), area.shape)
    radius = np.array(sizes_of(summits))
    if law == PARABOLOID:
        return radius, radius
    closed = area > 0.0
    a = np.where(closed, np.sqrt(area / math.pi), radius * SMALLEST)
    response = law.area_slope(a, summits) / math.pi
    source = 4.0 / 3.0 * a**3 / law.without_adhesion.load(a, summits)
    return np.where(closed, response, radius), np.where(closed, source, radius)


def slope_effects(
    law: Contact, surface: Surface, area: FloatArray, substrate: Substrate
) -> tuple[float, float]:
    """Return the relative changes of A0 by the slopes of the field in second order, and in the next one.

    The first change is part of order 3. The second one is that of ``1/sqrt(1 + 4 y)`` for the change -2 y of
    second order. Both are sums of absolute values; a contact loses at most its area.
    """
    closed = np.flatnonzero(area > 0.0)
    a, radius = np.sqrt(area[closed] / math.pi), np.broadcast_to(law.summits(surface), area.shape)[closed]
    load = np.zeros(area.shape)
    load[closed] = law.load(a, radius)
    if surface.count <= DENSE_LIMIT or surface.cell is not None:
        coupling, _ = coupling_between(surface, substrate, 3)
        _, _, x, y = coupling.fields
        slope = np.hypot(x @ load, y @ load)[closed]
    else:
        slope = _nearest_slopes(surface.position[closed], load[closed])
    change = np.abs(area_change(law, a, radius, slope))
    second, following = (np.minimum(part, 1.0) @ area[closed] for part in (change, 1.5 * change**2))
    return float(second / area.sum()), float(following / area.sum())


def nearest(position: FloatArray, cell: PeriodicCell | None = None) -> tuple[FloatArray, IntArray]:
    """Return the distances [mm] and the indices of the nearest neighbours of each position, (n, q) each."""
    distance, other, _ = neighbours(position, cell, NEIGHBOURS)
    return distance, other


def _nearest_slopes(position: FloatArray, load: FloatArray) -> FloatArray:
    """Return the slope at each contact of the field of its nearest neighbours on a half-space, (n,) [-]."""
    _, other = nearest(position)
    apart = position[:, None] - position[other]
    distance = np.linalg.norm(apart, axis=-1)
    field = load[other] / (math.pi * distance**3)
    return np.asarray(np.linalg.norm((field[..., None] * apart).sum(axis=1), axis=-1))


def _nearest_pairs(surface: Surface, response: FloatArray, source: FloatArray, area: FloatArray) -> float:
    """Return `pair_sum` restricted to the nearest neighbours of each contact."""
    closed = np.flatnonzero(area > 0.0)
    if closed.size < 2 and surface.cell is None:
        return 0.0
    contact_radius, response, source = np.sqrt(area[closed] / math.pi), response[closed], source[closed]
    position = surface.position[closed]
    distance, other = nearest(position, surface.cell)
    if (contact_radius[:, None] + contact_radius[other] >= distance).any():
        return math.inf
    terms = (contact_radius[other] / distance) ** 5 * response[:, None] / source[other]
    weights = np.maximum(area[closed, None], SMALL * area[closed][other])
    return float((weights * terms).sum() / area[closed].sum())


def crowding(surface: Surface, area: FloatArray, law: Contact = PARABOLOID) -> tuple[int, float]:
    """Return the number of overlapping pairs, and the largest ratio a/r of contact radius to distance.

    area: (n,) [mm^2]. For caps other than paraboloids, a is increased if the field of the contact is larger.
    """
    closed = np.flatnonzero(area > 0.0)
    if closed.size < 2 and surface.cell is None:
        return 0, 0.0
    a = np.sqrt(area / math.pi)[closed]
    # the field of j has the effect p_j r_i/r^3 = 4/3 (a_j/r)^3 r_i/s_j on i, so a_j is scaled by
    # cbrt(r_i/s_j)
    response, source = (radii[closed] for radii in equivalent_radii(law.bound(surface), surface, area))
    blunt, sharp = np.cbrt(response), a / np.cbrt(source)
    # pairs beyond this distance neither overlap nor exceed the ratio
    reach = max(2.0 * float(a.max()), float(sharp.max() * blunt.max()) * max(2.0, 1.0 / COMPARED))
    i, j, r = close_pairs(surface.position[closed], surface.cell, reach)
    if not i.size:
        return 0, 0.0
    bending = np.maximum(sharp[j] * blunt[i], sharp[i] * blunt[j])
    return int((a[i] + a[j] > r).sum()), float((np.maximum(np.maximum(a[i], a[j]), bending) / r).max())
