"""Sensitivity of A0 to the height or the shape of each cap for resolved contacts; lengths in cells.

On the cells with pressure ``K p = z - g``, where g is the depth of the undeformed surface and z the approach.
With the weights w = dA0/dp, a change dg of the depths at a fixed sum of p changes A0 by ``-l.dg``, where
``K l = w - x 1`` and the sum of l is zero. A height changes the depth of the cells of its asperity by one
constant, and a parameter of the cap changes it by the derivative of the profile. The area of a contact
follows from the load P and the second moment of its pressure as in `Summits.areas`, and depends on the shape
of the cap directly as well.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray
from metafem.contact import Contact
from metafem.contact.law import SMALL, area_change
from metafem.contact.law import STEP as BEND_STEP
from metafem.errors import refuse_if
from metafem.models.boundary_elements.patches import Patch
from metafem.models.boundary_elements.quadratic_program import solve_on
from metafem.models.boundary_elements.solve import MAX_ITERATIONS, Scene, Solution

# Largest residual of the equations for l, relative to the largest weight.
TOLERANCE = 1e-11

# Relative step of the contact radius in the central difference for the small part of the area that is due to
# the slope of the field.
STEP = 1e-4


class AreaRates(NamedTuple):
    """Derivatives of the contact areas [mm^2], (n,)."""

    load: FloatArray  # by P/E* [mm^2]
    spread: FloatArray  # by the spread [mm^2]
    shift: FloatArray  # by the shift [cells]
    shape: FloatArray  # by the parameter of the cap


class Moments(NamedTuple):
    """Moments of the pressure of one contact: the load, and those of the pressure over the load."""

    load: float
    centroid: FloatArray  # from the summit, (2,)
    second: FloatArray  # about the centroid, (2, 2)

    @property
    def spread(self) -> float:
        """Square root of the determinant of the second moments."""
        return math.sqrt(max(float(np.linalg.det(self.second)), 0.0))

    @property
    def shift(self) -> float:
        """Distance of the centroid from the summit."""
        return float(np.hypot(*self.centroid))


def area_gradient(scene: Scene, solution: Solution, own: Contact, by: str) -> FloatArray:
    """Return dA0 by the heights or by a parameter of the caps at fixed load, (n,); see `Sensitivity`.

    own: the contact law before it was bound to the caps.
    """
    contacts, count = solution.contacts, scene.surface.count
    shapeless = contacts.deformed & (contacts.load > 0.0)
    refuse_if(
        shapeless.any(),
        f"cannot be: {int(shapeless.sum())} resolved contacts have merged or do not have the shape of their "
        "law, and their areas have no derivatives; use the sensitivities of metafem.Interacting",
        key="by",
        value=repr(by),
    )
    pressure = _split(solution)
    moments = [_moments(scene, i, solution.patches, pressure) for i in range(count)]
    rates = _area_rates(scene, own, by, moments)
    adjoint = _adjoint(scene, solution, [_weights(scene, p, moments, rates) for p in solution.patches])
    found = rates.shape.copy()
    for patch, values in zip(solution.patches, adjoint, strict=True):
        for i in np.unique(patch.owner[values != 0.0]):
            here = (patch.owner == i) & (values != 0.0)
            change = -np.ones(int(here.sum()))
            if by != "height":
                distance = scene.cell * np.linalg.norm(_offsets(scene, patch, i)[:, here], axis=0)
                change = own.profile_rate(by, distance, scene.surface, int(i))
            found[i] -= float(values[here] @ change) / scene.cell
    return found


def _split(solution: Solution) -> list[FloatArray]:
    """Return the pressures of the patches in their shapes."""
    sizes = np.cumsum([patch.gap.size for patch in solution.patches])[:-1]
    parts = np.split(solution.minimum.pressure, sizes)
    return [part.reshape(patch.shape) for part, patch in zip(parts, solution.patches, strict=True)]


def _offsets(scene: Scene, patch: Patch, i: int) -> FloatArray:
    """Return the positions of cells from the summit of asperity i, (2, rows, columns)."""
    grid = np.indices(patch.shape, dtype=np.float64)
    return np.asarray(grid + (patch.corner - scene.summits.position[i])[:, None, None])


def _moments(scene: Scene, i: int, patches: list[Patch], pressure: list[FloatArray]) -> Moments:
    """Return the moments of the pressure of asperity i."""
    parts = []
    for patch, p in zip(patches, pressure, strict=True):
        here = (patch.owner == i) & (p > 0.0)
        if here.any():
            parts.append((p[here], _offsets(scene, patch, i)[:, here]))
    if not parts:
        return Moments(0.0, np.zeros(2), np.zeros((2, 2)))
    p, at = np.concatenate([part for part, _ in parts]), np.concatenate([x for _, x in parts], axis=1)
    load = math.fsum(p)
    centroid = at @ p / load
    at = at - centroid[:, None]
    return Moments(load, centroid, (at * p) @ at.T / load)


def _area_rates(scene: Scene, own: Contact, by: str, moments: list[Moments]) -> AreaRates:
    """Return the derivatives of the weighted areas by load, spread, shift and the parameter of the caps.

    In mm, the contact radius a without the slope g is the root of ``M - 2/5 a^2 P0 + 2/5 a^2 P - 2 s P``,
    with M and P0 of an isolated contact; the area is ``pi a^2 (1 + y)`` with y proportional to g^2.
    """
    h, law, radius = scene.cell, scene.law, scene.summits.of_law
    load, spread, shift = np.array([(one.load, one.spread, one.shift) for one in moments]).T
    area = scene.summits.areas(spread, load, shift)
    closed = area > 0.0
    carried = h**2 * np.where(closed, load, 1.0)
    a = _contact_radius(scene, spread, load)
    a = np.where(closed, a, SMALL * scene.surface.radius)
    slope, alone = law.profile_slope(a, radius), law.load(a, radius)
    by_radius = 8.0 / 15.0 * a**3 * slope - 0.8 * a * (alone - carried)
    y = _change(scene, a, carried, shift)
    up, down = (_change(scene, (1.0 + sign * STEP) * a, carried, shift) for sign in (1.0, -1.0))
    wide = math.pi * (2.0 * a * (1.0 + y) + a**2 * (up - down) / (2.0 * STEP * a)) / by_radius
    sloped = 2.0 * math.pi * a**2 * y
    shape = np.zeros_like(a)
    if by != "height":
        rates = own.shape_rates(by, a, scene.surface)
        shape = -wide * (rates.moment - 0.4 * a**2 * rates.load)
        shape += _shape_of_change(scene, own, by, a, carried, shift)
    parts = (
        -wide * (0.4 * a**2 - 2.0 * h**2 * spread) + sloped / carried,
        wide * 2.0 * carried,
        np.divide(sloped, shift, out=np.zeros_like(a), where=shift > 0.0),
        shape,
    )
    return AreaRates(*(np.where(closed, part, 0.0) for part in parts))


def _contact_radius(scene: Scene, spread: FloatArray, load: FloatArray) -> FloatArray:
    """Return the contact radii [mm] without a slope of the field, (n,)."""
    area = scene.summits.areas(spread, load, np.zeros_like(spread))
    return np.asarray(scene.cell * np.sqrt(area / math.pi))


def _change(scene: Scene, a: FloatArray, load: FloatArray, shift: FloatArray) -> FloatArray:
    """Return the relative change y of the area by the slope of the field, at contact radii a [mm], (n,)."""
    law, radius = scene.law, scene.summits.of_law
    gradient, slope = load * scene.cell * shift / (4.0 / 3.0 * a**3), law.profile_slope(a, radius)
    seen = 10.0 - 20.0 / 3.0 * a**2 * slope / law.load(a, radius)
    return np.asarray(area_change(law, a, radius, gradient) - seen * (gradient / slope) ** 2)


def _shape_of_change(
    scene: Scene, own: Contact, by: str, a: FloatArray, load: FloatArray, shift: FloatArray
) -> FloatArray:
    """Return the derivative of pi a^2 y by the parameter at given a, (n,); `area_change` states y."""
    law, radius, surface = scene.law, scene.summits.of_law, scene.surface
    slope, alone = law.profile_slope(a, radius), law.load(a, radius)
    steep = (load * scene.cell * shift / (4.0 / 3.0 * a**3) / slope) ** 2
    inside = (1.0 - BEND_STEP) * a
    here, near = own.shape_rates(by, a, surface), own.shape_rates(by, inside, surface)
    bend = (here.slope / slope - near.slope / law.profile_slope(inside, radius)) / -math.log1p(-BEND_STEP)
    seen = 20.0 / 3.0 * a**2 * (here.slope - slope * here.load / alone) / alone
    y = _change(scene, a, load, shift)
    return np.asarray(math.pi * a**2 * (steep * (seen - 2.0 * bend) - 2.0 * y * here.slope / slope))


def _weights(scene: Scene, patch: Patch, moments: list[Moments], rates: AreaRates) -> FloatArray:
    """Return dA0/dp of the cells of a patch [mm^2]."""
    h, weight = scene.cell, np.zeros(patch.shape)
    for i in np.unique(patch.owner):
        one = moments[i]
        if one.load == 0.0:
            continue
        here = patch.owner == i
        x, y = _offsets(scene, patch, int(i))[:, here] - one.centroid[:, None]
        (xx, xy), (_, yy) = one.second
        square = yy * x**2 + xx * y**2 - 2.0 * xy * x * y - 2.0 * one.spread**2
        spread = h**2 * rates.spread[i] * square / (2.0 * one.spread)
        shift = 0.0
        if one.shift > 0.0:
            shift = rates.shift[i] * (one.centroid[0] * x + one.centroid[1] * y) / one.shift
        weight[here] = h**2 * rates.load[i] + (spread + shift) / one.load
    return weight


def _adjoint(scene: Scene, solution: Solution, weights: list[FloatArray]) -> list[FloatArray]:
    """Return l on the cells of the patches; zero where there is no pressure."""
    operator, face = scene.influence(solution.patches), solution.minimum.pressure > 0.0
    weight = np.concatenate([part.ravel() for part in weights])
    largest = float(np.abs(weight[face]).max())
    given, ones = (
        solve_on(operator, face, right, TOLERANCE * size, MAX_ITERATIONS)
        for right, size in ((weight, largest), (np.ones_like(weight), 1.0))
    )
    balanced = given - given.sum() / ones.sum() * ones
    return [np.asarray(part) for part in operator.split(np.where(face, balanced, 0.0))]
