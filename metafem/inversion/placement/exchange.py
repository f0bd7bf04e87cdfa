"""Sites, and forecasts of the residuals after exchanges of asperities between sites.

An empty site is treated as a vacancy, which carries no load and is exchanged like an asperity.

To first order, interaction changes A0 by a bilinear form of the loads and of the sensitivities dA0/dh at the
sites. A tilt changes A0 by a sum over the sites. An exchange of two asperities changes only the terms of
their two sites.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._validate import FloatArray, IntArray
from metafem.caps import SPHERE
from metafem.contact import Contact
from metafem.errors import refuse_if
from metafem.models import Model
from metafem.models._resources import require_memory
from metafem.substrate import Radial
from metafem.surface import Surface

# Maximum number of sites for which all searches make their full number of trials.
FEW_SITES = 128

# Maximum number of sites whose exchanges are forecast in one step. If there are more sites, this number of
# sites is drawn at random.
FORECAST_SITES = 96

# A decrease of the sum of squares by less than this fraction is attributed to rounding.
EXCHANGE_GAIN = 1e-9

# Number of (m, m) matrices that are in memory while the influence between m sites is computed.
MATRICES = 3


@dataclass(frozen=True, eq=False)
class Sites:
    """Positions of sites (m, 2) [mm], and the influence between the sites (m, m) [1/mm].

    With `derivatives` the value can be used as the substrate of surfaces on some of the sites.
    """

    position: FloatArray
    influence: FloatArray
    derivatives: tuple[FloatArray, ...] = ()

    @cached_property
    def index(self) -> dict[tuple[float, float], int]:
        """Index of the site at each position [mm]."""
        return {(x, y): i for i, (x, y) in enumerate(self.position.tolist())}

    def indices(self, position: FloatArray) -> IntArray:
        """Return the indices of the sites at positions (n, 2) [mm], (n,)."""
        found = [self.index.get((x, y), -1) for x, y in position.tolist()]
        i = found.index(-1) if -1 in found else 0
        x, y = position[i]
        words = f"position[{i}] = ({x:g}, {y:g}) of the surface is not among the given ones"
        refuse_if(found[i] < 0, words)
        return np.array(found)

    def for_surface(self, surface: Surface) -> Sites:
        """Return this substrate, which is the same for all surfaces."""
        return self

    def influence_matrix(self, surface: Surface) -> FloatArray:
        """Return the displacement at each asperity per P/E* on each asperity, (n, n) [1/mm]."""
        return np.asarray(self.influence[self._pairs(surface)])

    def influence_derivatives(self, surface: Surface) -> tuple[FloatArray, ...]:
        """Return the gradient [1/mm^2] and the Laplacian [1/mm^3] of the displacement, (n, n) each."""
        pairs = self._pairs(surface)
        return tuple(part[pairs] for part in self.derivatives)

    def _pairs(self, surface: Surface) -> tuple[IntArray, ...]:
        rows = self.indices(surface.position)
        return np.ix_(rows, rows)


def sites_for(surface: Surface, model: Model, position: ArrayLike | None) -> tuple[Sites, Model]:
    """Return the sites (default: the sites of the surface), and the model for surfaces on these sites.

    The influence is that of the model's substrate; it is zero for independent asperities. If the substrate is
    not radial and there are more sites than asperities, the influence and its derivatives are computed only
    once, and the returned model uses them.
    """
    given = surface.position
    if position is not None:
        given = check.array("position", position, shape=(None, 2))
    count = len(given)
    require_memory(MATRICES * 8 * count**2, f"the influence between {count} sites")
    everywhere = surface.replaced(
        position=given, height=np.zeros(count), radius=float(surface.radius.min()), cap=SPHERE
    )
    if not model.couples:
        return Sites(given, np.zeros((count, count))), model
    substrate = model.reference.substrate
    sites = Sites(given, np.asarray(substrate.influence_matrix(everywhere)))
    if isinstance(substrate, Radial) or count == surface.count:
        return sites, model
    coupled: Any = model
    known = replace(sites, derivatives=substrate.influence_derivatives(everywhere))
    return known, replace(coupled, substrate=known)


@dataclass(frozen=True, eq=False)
class Coupled:
    """Predicted residuals ``sum_ij left_i G_ij right_j``.

    `left` and `right`, (q, m), are values of the asperities at the sites. `fields` stores the products of
    each with the influence G, (q, m). An exchange changes these products only by the rows of G for the two
    sites.
    """

    left: FloatArray
    right: FloatArray
    influence: FloatArray
    fields: tuple[FloatArray, FloatArray] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "fields", (self.left @ self.influence, self.right @ self.influence))

    def swapped(self, i: int, j: int) -> Coupled:
        """Return the forecast after an exchange of the asperities at two sites."""
        result = copy(self)
        pair, turned = [i, j], [j, i]
        between = self.influence[i] - self.influence[j]
        fields = []
        for name, old in zip(("left", "right"), self.fields, strict=True):
            values = getattr(self, name).copy()
            fields.append(old + (values[:, j] - values[:, i])[:, None] * between)
            values[:, pair] = values[:, turned]
            object.__setattr__(result, name, values)
        object.__setattr__(result, "fields", tuple(fields))
        return result

    def residual(self) -> FloatArray:
        """Return the residuals, (q,)."""
        return np.asarray((self.fields[0] * self.right).sum(axis=1))

    def changes(self, sites: IntArray) -> FloatArray:
        """Return the changes of the residuals due to an exchange between each pair of sites, (q, m, m)."""
        influence = self.influence[np.ix_(sites, sites)]
        diagonal = np.diagonal(influence)

        def difference(values: FloatArray) -> FloatArray:
            """Return the value at the second site minus the value at the first site, (q, m, m)."""
            part = values[:, sites]
            return np.asarray(part[:, None, :] - part[:, :, None])

        left, right = difference(self.left), difference(self.right)
        change = left * right * (2.0 * influence - diagonal[:, None] - diagonal[None, :])
        change += left * difference(self.fields[1])
        change += right * difference(self.fields[0])
        return np.asarray(-change)


@dataclass(frozen=True, eq=False)
class Tilted:
    """Predicted relative changes of A0 by tilts of independent asperities, at fixed load.

    The tilt changes both the area and the load at a fixed separation. The slope of the law converts the
    change of load to a change of area. The change of A0 at fixed load is the change of
    ``sum_i A(d_i) - dA0/dP sum_i P(d_i)`` by the tilt, with the indentations d_i at fixed separation.
    """

    law: Contact
    depth: FloatArray  # (k, m), indentations of the asperities before the tilt [mm], negative where open
    radius: FloatArray  # (m,) R of the asperities [mm]
    lift: FloatArray  # (t, m), rise of each site by each tilt [mm]
    scale: FloatArray  # (k,), factor of the changes [1/mm^2]
    rate: FloatArray  # (k,), dA0/d(P/E*) [-]

    def swapped(self, i: int, j: int) -> Tilted:
        """Return the forecast after an exchange of the asperities at two sites."""
        order = np.arange(len(self.radius))
        swap(order, i, j)
        return replace(self, depth=self.depth[:, order], radius=self.radius[order])

    def residual(self) -> FloatArray:
        """Return the residuals, (t k,)."""
        tilted = self._value(self.depth[None] + self.lift[:, None], self.radius)
        return np.asarray((tilted - self._value(self.depth[None], self.radius)).sum(axis=-1).ravel())

    def changes(self, sites: IntArray) -> FloatArray:
        """Return the changes of the residuals due to an exchange between each pair of sites, (t k, m, m)."""
        # index [..., a, b]: the asperity of site a at site b
        depth = self.depth[:, sites]
        tilted = depth[None, :, :, None] + self.lift[:, sites][:, None, None, :]
        rows = len(self.lift) * len(self.depth)
        value = self._value(tilted, self.radius[sites][:, None]).reshape(rows, len(sites), -1)
        diagonal = np.diagonal(value, axis1=1, axis2=2)
        return np.asarray(value + value.transpose(0, 2, 1) - diagonal[:, :, None] - diagonal[:, None, :])

    def _value(self, depth: FloatArray, radius: FloatArray) -> FloatArray:
        tail = (1,) * (depth.ndim - 2)
        scale, rate = self.scale.reshape(-1, *tail), self.rate.reshape(-1, *tail)
        a = self.law.contact_radius(depth, radius)
        return np.asarray(scale * (self.law.area(a) - rate * self.law.load(a, radius)))


@dataclass(frozen=True, eq=False)
class Joined:
    """Several forecasts, each multiplied by a factor."""

    factors: tuple[float, ...]
    parts: tuple[Forecast, ...]

    def swapped(self, i: int, j: int) -> Joined:
        """Return the forecast after an exchange of the asperities at two sites."""
        return replace(self, parts=tuple(part.swapped(i, j) for part in self.parts))

    def residual(self) -> FloatArray:
        """Return the residuals, (q,)."""
        return np.concatenate([f * part.residual() for f, part in zip(self.factors, self.parts, strict=True)])

    def changes(self, sites: IntArray) -> FloatArray:
        """Return the changes of the residuals due to an exchange between each pair of sites, (q, m, m)."""
        pairs = zip(self.factors, self.parts, strict=True)
        return np.concatenate([f * part.changes(sites) for f, part in pairs])


# Predicted residuals (q,) of the asperities at their sites.
Forecast = Coupled | Tilted | Joined


def after(residual: FloatArray, change: FloatArray) -> FloatArray:
    """Return the sum of squares of the residuals after each exchange, (m, m)."""
    flat = change.reshape(len(residual), -1)
    squares = (flat * flat).sum(axis=0) + 2.0 * (residual @ flat) + residual @ residual
    return np.asarray(squares.reshape(change.shape[1:]))


def swap(order: IntArray, i: int, j: int) -> None:
    """Exchange two entries in place."""
    order[i], order[j] = order[j], order[i]
