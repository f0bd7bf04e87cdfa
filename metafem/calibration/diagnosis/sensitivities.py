"""Contact areas of a part at given loads, and their derivatives with respect to its errors."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, cast

import numpy as np

from metafem._validate import FloatArray
from metafem.calibration.diagnosis.causes import Made
from metafem.contact import Contact
from metafem.models import Model
from metafem.models.independent import load_equation
from metafem.models.model import contact_of, with_contact
from metafem.surface import Surface

# Relative step of E*, sqrt(w) and radii in central differences of a contact law. The relative error of a
# central difference is about the square of the step.
STEP = 1e-4
FACTORS = (1.0 - STEP, 1.0 + STEP)

# Indentation over R up to which the rate of the latent area of an open contact is averaged: 0.5 um for the
# paper's radius, the error of a height. The area of a cap other than a paraboloid has no finite rate at the
# first touch, or the rate 0.
TOUCH = 1e-3

# Mean areas are integrals over indentations up to FAR standard deviations from their means, by Gauss-Legendre
# quadrature in the square root of the indentation, in which the areas of power caps are smooth at the first
# touch.
FAR = 6.0
NODE, WEIGHT = np.polynomial.legendre.leggauss(32)


@dataclass(frozen=True, eq=False)
class Response:
    """State of the n contacts of a surface at k rescaled loads; arrays are (k, n) unless stated otherwise.

    An open contact has the negative area ``r d``, where -d is its gap and r the mean of dA/dd after the first
    touch: pi R for spheres, for which the area is differentiable where the contact closes. For independent
    contacts

        dA_i = A'_i (dh_i - sum_j s_j dh_j + dq / sum_j p'_j),   s_j = p'_j / sum_j p'_j

    where A' is the derivative of the area with respect to the indentation, p' the stiffness of a contact, and
    dh and dq the changes of the heights and of the rescaled load.
    """

    area: FloatArray  # [mm^2]
    indentation: FloatArray  # d [mm]
    area_rate: FloatArray  # A' [mm]
    share: FloatArray  # s [-]
    stiffness: FloatArray  # (k,), sum of p' [mm]
    load_by_radius: FloatArray  # derivative of each load with respect to the radius [mm]
    area_by_radius: FloatArray  # derivative with respect to the radius at fixed indentation [mm]
    # derivatives of indentation [mm] and rescaled load [mm^2] with respect to log E* and log sqrt(w), at
    # fixed contact radii, (2, k, n)
    by_modulus: FloatArray
    by_adhesion: FloatArray
    law: Contact
    summits: Any  # (n,), as the law takes them

    def mean_areas(self, sd: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the means (k, n) of uncertain areas, and their derivatives by the mean indentations.

        sd: standard deviations of the indentations (k, n) [mm], which are normally distributed. The
        derivative of the mean of A(d) is the mean of ``A(d) (d - mean)/sd^2``.
        """
        closed = self.area > 0.0
        mean, rate = np.maximum(self.area, 0.0), np.where(closed, self.area_rate, 0.0)
        row, column = np.nonzero(np.abs(self.indentation) < FAR * sd)
        middle, width = self.indentation[row, column, None], sd[row, column, None]
        low, high = (np.sqrt(np.maximum(middle + side * width, 0.0)) for side in (-FAR, FAR))
        summits = np.broadcast_to(self.summits, self.area.shape)[row, column, None]
        high = np.minimum(high, np.sqrt(self.law.largest_indentation(summits)))
        root = 0.5 * (low + high + (high - low) * NODE)
        away = (root**2 - middle) / width
        density = np.exp(-0.5 * away**2) / (math.sqrt(2.0 * math.pi) * width)
        part = self.law.area(self.law.contact_radius(root**2, summits)) * density
        part = part * root * (high - low) * WEIGHT
        mean[row, column], rate[row, column] = part.sum(axis=1), (part * away / width).sum(axis=1)
        return mean, rate

    def by_height(self, change: FloatArray) -> FloatArray:
        """Return the derivatives of the areas (k, n) if an error changes the heights by `change` (n,)."""
        return self.area_rate * (change - self.share @ change[:, None])

    def by_each_height(self) -> FloatArray:
        """Return the derivatives of the areas with respect to each height, (k, n, n)."""
        n = self.area.shape[1]
        return self.area_rate[:, :, None] * (np.eye(n) - self.share[:, None, :])

    def by_each_radius(self) -> FloatArray:
        """Return the derivatives of the areas with respect to each radius, (k, n, n)."""
        sinking = self.load_by_radius / self.stiffness[:, None]
        found = -self.area_rate[:, :, None] * sinking[:, None, :]
        i = np.arange(self.area.shape[1])
        found[:, i, i] += self.area_by_radius
        return found

    def by_law(self, change: FloatArray, load: FloatArray | float = 0.0) -> FloatArray:
        """Return the derivatives of the areas with respect to a parameter of the contact law, (k, n).

        `change` holds the changes x_i and y_i of the indentation and the load of each contact at a fixed
        contact radius. q is the change of the total rescaled load, `load` (k,). Then
        ``dA_i = A'_i (c - x_i)``, where c follows from ``sum_i (p'_i (c - x_i) + y_i) = q``.
        """
        x, y = change
        common = (self.share * x).sum(axis=1) + (load - y.sum(axis=1)) / self.stiffness
        return np.asarray(self.area_rate * (common[:, None] - np.where(self.area > 0.0, x, 0.0)))

    def by_load(self) -> FloatArray:
        """Return the derivatives of the areas with respect to the rescaled load, (k, n)."""
        return self.area_rate / self.stiffness[:, None]


def response(model: Model, part: Made, load: FloatArray) -> Response:
    """Return the contacts at rescaled loads (k,) in any order; the derivatives neglect interaction."""
    surface = part.surface
    contact = with_adhesion(contact_of(model), part.factor["adhesion_root"])
    law, radius = contact.bound(surface), contact.summits(surface)
    touching = touching_rate(contact, surface)
    if model.couples:
        size, indentation = _states(with_contact(model, contact), surface, load)
    else:
        order = np.argsort(load, kind="stable")
        size, indentation = np.empty((2, len(load), surface.count))
        size[order], indentation[order] = load_equation(law).contacts(surface.height, radius, load[order])
    closed = size > 0.0
    if model.couples:  # the indentation of a contact of the same area without neighbours
        indentation = np.where(closed, _where_closed(law.indentation, size, radius), indentation)
    stiffness = _where_closed(law.stiffness, size, radius)
    rate = np.where(closed, _where_closed(law.area_slope, size, radius), touching)
    area = np.where(closed, law.area(size), touching * np.minimum(indentation, 0.0))
    # If indentation and load change by x and y at a fixed contact radius, then the load changes by
    # ``y - p' x`` and the area by ``-A' x`` at a fixed indentation.
    scaled = [factor * surface.radius for factor in FACTORS]
    x, y = _by_radius(contact, surface, size, scaled)
    less, more = (touching_rate(contact, surface, each) for each in scaled)
    latent = indentation * (more - less) / (2.0 * STEP * surface.radius)
    load_by_radius, area_by_radius = y - stiffness * x, np.where(closed, -rate * x, latent)
    total = stiffness.sum(axis=1)
    return Response(
        area,
        indentation,
        rate,
        stiffness / total[:, None],
        total,
        load_by_radius,
        area_by_radius,
        *law_changes(contact, surface, size, radius),
        law,
        radius,
    )


def touching_rate(contact: Contact, surface: Surface, radius: FloatArray | None = None) -> FloatArray:
    """Return the mean of dA/dd [mm] of all asperities up to a small indentation, without adhesion.

    radius: R of the asperities (n,) [mm]; default: the surface's.
    """
    law, summits = contact.without_adhesion.bound(surface), contact.summits(surface, radius)
    depth = np.minimum(TOUCH * surface.radius, law.largest_indentation(summits))
    return np.asarray(law.area(law.contact_radius(depth, summits)) / depth)


def law_changes(
    contact: Contact, surface: Surface, size: FloatArray, radius: Any
) -> tuple[FloatArray, FloatArray]:
    """Return the derivatives of indentation and load, (2, ...), by log E*, and by log sqrt(w).

    radius: the summits of the asperities with the contact radii `size`, as the bound law takes them.
    """
    material = surface.material
    moduli = (replace(material, composite_modulus=f * material.composite_modulus) for f in FACTORS)
    by_modulus = [contact.bound(surface.replaced(material=each)) for each in moduli]
    by_adhesion = [with_adhesion(contact, factor).bound(surface) for factor in FACTORS]
    low, high = (_depth_and_load(law, size, radius) for law in by_modulus)
    less, more = (_depth_and_load(law, size, radius) for law in by_adhesion)
    # the derivatives are 0 for laws that do not depend on E* or w
    return (high - low) / (2.0 * STEP), (more - less) / (2.0 * STEP)


def with_adhesion(contact: Contact, root: float) -> Contact:
    """Return the contact law with its sqrt(w), if it is adhesive, multiplied by the factor `root`."""
    if root == 1.0 or not contact.adhesive:
        return contact
    adhesive: Any = contact
    return cast("Contact", replace(adhesive, adhesion_energy=root**2 * adhesive.adhesion_energy))


def _by_radius(contact: Contact, surface: Surface, size: FloatArray, scaled: list[FloatArray]) -> FloatArray:
    """Return the derivatives of indentation and load by R at fixed contact radii, (2, k, n).

    scaled: the radii times FACTORS.
    """
    law = contact.bound(surface)
    low, high = (_depth_and_load(law, size, contact.summits(surface, each)) for each in scaled)
    return np.asarray((high - low) / (2.0 * STEP * surface.radius))


def _depth_and_load(law: Contact, size: FloatArray, radius: Any) -> FloatArray:
    """Return indentation and load at contact radii, (2, ...); 0 where the contact is open."""
    return np.array([_where_closed(of, size, radius) for of in (law.indentation, law.load)])


def _where_closed(value: Callable[..., Any], size: FloatArray, radius: Any) -> FloatArray:
    """Return a quantity of a contact law at contact radii; 0 where the contact is open."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(size > 0.0, value(size, radius), 0.0)


def _states(model: Model, surface: Surface, load: FloatArray) -> FloatArray:
    """Return the contact radii and indentations of the contacts, (2, k, n)."""
    size, indentation = found = np.empty((2, len(load), surface.count))
    for k, value in enumerate(load):
        state = model.curve(surface, np.array([value])).checked().last
        size[k], indentation[k] = np.sqrt(state.area / math.pi), state.indentation
    return found
