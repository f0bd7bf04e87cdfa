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
from metafem.models.model import PARABOLOID, contact_of, with_contact
from metafem.surface import Material, Surface

# Relative step of E*, sqrt(w) and radii in central differences of a contact law. The relative error of a
# central difference is about the square of the step.
STEP = 1e-4
FACTORS = (1.0 - STEP, 1.0 + STEP)


@dataclass(frozen=True, eq=False)
class Response:
    """State of the n contacts of a surface at k rescaled loads; arrays are (k, n) unless stated otherwise.

    An open contact has the negative area ``pi R d``, where -d is its gap, so that the area is differentiable
    where the contact closes. For independent contacts

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
    law = contact.bound(surface)
    radius = surface.radius
    if model.couples:
        size, indentation, carried = _states(with_contact(model, contact), surface, load)
    else:
        order = np.argsort(load, kind="stable")
        size, indentation = np.empty((2, len(load), len(radius)))
        size[order], indentation[order] = load_equation(law).contacts(surface.height, radius, load[order])
        carried = _where_closed(law.load, size, radius)
    closed = size > 0.0
    stiffness = _where_closed(law.stiffness, size, radius)
    rate = np.where(closed, _where_closed(law.area_slope, size, radius), math.pi * radius)
    area = np.where(closed, law.area(size), math.pi * radius * np.minimum(indentation, 0.0))
    # If indentation and load change by x and y at a fixed contact radius, then the load changes by
    # ``y - p' x`` and the area by ``-A' x`` at a fixed indentation. The negative area of an open contact is
    # pi R d.
    latent = math.pi * indentation
    if law == PARABOLOID:
        load_by_radius, area_by_radius = carried / (2.0 * radius), latent
    else:
        low, high = (_depth_and_load(law, size, factor * radius) for factor in FACTORS)
        x, y = (high - low) / (2.0 * STEP * radius)
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
        *law_changes(contact, surface.material, size, radius),
    )


def law_changes(
    contact: Contact, material: Material, size: FloatArray, radius: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the derivatives of indentation and load, (2, ...), by log E*, and by log sqrt(w)."""
    moduli = (replace(material, composite_modulus=f * material.composite_modulus) for f in FACTORS)
    by_modulus = [contact.for_material(each) for each in moduli]
    by_adhesion = [with_adhesion(contact, factor).for_material(material) for factor in FACTORS]
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


def _depth_and_load(law: Contact, size: FloatArray, radius: FloatArray) -> FloatArray:
    """Return indentation and load at contact radii, (2, ...); 0 where the contact is open."""
    return np.array([_where_closed(of, size, radius) for of in (law.indentation, law.load)])


def _where_closed(value: Callable[..., Any], size: FloatArray, radius: FloatArray) -> FloatArray:
    """Return a quantity of a contact law at contact radii; 0 where the contact is open."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(size > 0.0, value(size, radius), 0.0)


def _states(model: Model, surface: Surface, load: FloatArray) -> tuple[FloatArray, ...]:
    """Return the contact radii, indentations and rescaled loads of the contacts, (k, n) each."""
    size, indentation, carried = np.empty((3, len(load), surface.count))
    for k, value in enumerate(load):
        state = model.curve(surface, np.array([value])).checked().last
        size[k], indentation[k], carried[k] = np.sqrt(state.area / math.pi), state.indentation, state.load
    return size, indentation, carried
