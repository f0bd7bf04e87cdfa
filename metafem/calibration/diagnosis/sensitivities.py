"""Areas of the contacts of a part at given loads, and their derivatives by its errors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from metafem._validate import FloatArray
from metafem.models import Independent, Model
from metafem.models.model import PARABOLOID, contact_of
from metafem.surface import Material, Surface


@dataclass(frozen=True, eq=False)
class Response:
    """Contacts of a surface at k rescaled loads, all arrays (k, n).

    The area of an open contact is negative: ``pi R d`` with its gap -d, so that it is differentiable where
    the contact closes. With shares s_j and the area's rate A' by the indentation, an independent contact has

        dA_i = A'_i (dh_i - sum_j s_j dh_j + dq / sum_j p'_j),   s_j = p'_j / sum_j p'_j

    at a change dh of the heights and dq of the load, p' the stiffness of a contact.
    """

    area: FloatArray  # [mm^2]
    area_rate: FloatArray  # A' [mm]
    share: FloatArray  # s [-]
    stiffness: FloatArray  # (k,), sum of p' [mm]
    load_by_radius: FloatArray  # derivative of the load of each contact by its radius [mm]
    area_by_radius: FloatArray  # derivative of the area by the radius at fixed indentation [mm]

    def by_height(self, change: FloatArray) -> FloatArray:
        """Return the derivative of the areas by an error that changes the heights by `change` (n,)."""
        return self.area_rate * (change - self.share @ change[:, None])

    def by_each_height(self) -> FloatArray:
        """Return the derivatives of the areas by each height, (k, n, n)."""
        n = self.area.shape[1]
        return self.area_rate[:, :, None] * (np.eye(n) - self.share[:, None, :])

    def by_each_radius(self) -> FloatArray:
        """Return the derivatives of the areas by each radius, (k, n, n)."""
        sinking = self.load_by_radius / self.stiffness[:, None]
        found = -self.area_rate[:, :, None] * sinking[:, None, :]
        i = np.arange(self.area.shape[1])
        found[:, i, i] += self.area_by_radius
        return found

    def by_load(self) -> FloatArray:
        """Return the derivative of the areas at each rescaled load by that load."""
        return self.area_rate / self.stiffness[:, None]


class Part(Protocol):
    """A made part; `surface` is needed by models other than independent Hertz contacts."""

    @property
    def height(self) -> FloatArray:
        """Heights of the summits, (n,) [mm]."""

    @property
    def radius(self) -> FloatArray:
        """Radii of the summits, (n,) [mm]."""

    @property
    def material(self) -> Material:
        """Its material."""

    @property
    def surface(self) -> Surface:
        """All of it."""


def response(model: Model, part: Part, load: FloatArray) -> Response:
    """Return the contacts at rescaled loads (k,) in any order; derivatives are of independent asperities."""
    law = contact_of(model).for_material(part.material)
    radius = part.radius
    if type(model) is Independent and law == PARABOLOID:
        order = np.argsort(load, kind="stable")
        curve = model.curve_of(part.height, radius, load[order])
        approach = np.empty(len(load))
        approach[order] = curve.approach
        indentation = approach[:, None] - (part.height.max() - part.height)
        closed = np.maximum(indentation, 0.0)
        each = 2.0 * np.sqrt(radius * closed)
        rate = np.broadcast_to(math.pi * radius, indentation.shape)
        area, carried = math.pi * radius * indentation, each * closed * (2.0 / 3.0)
    else:
        area, each, rate, carried = _states(model, part.surface, load)
    total = each.sum(axis=1)
    return Response(area, rate, each / total[:, None], total, carried / (2.0 * radius), area / radius)


def _states(model: Model, surface: Surface, load: FloatArray) -> tuple[FloatArray, ...]:
    """Return areas, stiffnesses, rates of the areas and rescaled loads of the contacts of any model."""
    law = contact_of(model).for_material(surface.material)
    area, each, rate, carried = np.empty((4, len(load), surface.count))
    for k, value in enumerate(load):
        state = model.curve(surface, np.array([value])).checked().last
        closed = state.area > 0.0
        size = np.sqrt(state.area / math.pi)
        with np.errstate(divide="ignore", invalid="ignore"):
            slope = law.area_slope(size, surface.radius)
            stiff = law.stiffness(size, surface.radius)
        rate[k] = np.where(closed, slope, math.pi * surface.radius)
        each[k] = np.where(closed, stiff, 0.0)
        area[k] = np.where(closed, state.area, math.pi * surface.radius * np.minimum(state.indentation, 0.0))
        carried[k] = state.load
    return area, each, rate, carried


def has_closed_derivatives(model: Model) -> bool:
    """Whether the derivatives of `response` are those of the model by errors of heights, load and E*.

    Those of contacts whose law changes with E*, by adhesion or yield, leave this change out.
    """
    return type(model) is Independent
