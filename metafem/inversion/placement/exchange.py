"""Exchanges of asperities between places, by a forecast that prices all of them at once.

An empty place holds a vacancy, which carries nothing and is exchanged as an asperity is.

To first order in what asperities in other places feel of each other, the change of A0 is a quadratic form
in what they carry and how they weigh, each at its place; that by a tilt is a sum over the places.
Exchanging two asperities changes both by terms of the two places alone.
"""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Protocol

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact import Hertz

# Places among which all exchanges are priced in one step; of more places, so many are drawn at random.
PRICED_AT_ONCE = 96

# A gain below this share of the sum of squares is rounding.
LEAST_GAIN = 1e-9


# Exchanges end where the forecast expects a misfit that is far below what it can tell.
ENOUGH = 1e-6


class Forecast(Protocol):
    """Residuals (q,) of asperities in their places."""

    def swapped(self, i: int, j: int) -> Forecast:
        """Return the forecast with the asperities of two places exchanged."""
        ...

    def residual(self) -> FloatArray:
        """Return the residuals, (q,)."""
        ...

    def changes(self, places: IntArray) -> FloatArray:
        """Return their changes by the exchange of each two of the places, (q, m, m)."""
        ...


@dataclass(frozen=True, eq=False)
class Coupled:
    """``sum_ij left_i G_ij right_j``: left and right (q, m) move with the asperities.

    The fields of both at the places (q, m), a product with G each, are kept: an exchange changes them by
    the two places' rows of G alone.
    """

    left: FloatArray
    right: FloatArray
    influence: FloatArray
    fields: tuple[FloatArray, FloatArray] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "fields", (self.left @ self.influence, self.right @ self.influence))

    def swapped(self, i: int, j: int) -> Coupled:
        """Return the forecast with the asperities of two places exchanged."""
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

    def changes(self, places: IntArray) -> FloatArray:
        """Return their changes by the exchange of each two of the places, (q, m, m)."""
        influence = self.influence[np.ix_(places, places)]
        own = np.diagonal(influence)

        def difference(values: FloatArray) -> FloatArray:
            """At the second place less at the first."""
            part = values[:, places]
            return np.asarray(part[:, None, :] - part[:, :, None])

        left, right = difference(self.left), difference(self.right)
        change = left * right * (2.0 * influence - own[:, None] - own[None, :])
        change += left * difference(self.fields[1])
        change += right * difference(self.fields[0])
        return np.asarray(-change)


@dataclass(frozen=True, eq=False)
class Tilted:
    """Relative changes of A0 by tilts of independent asperities, at fixed load.

    The load that a tilt adds at a fixed separation is given back along the law,
    ``dA = sum_i pi R_i d_i - dA0/dP sum_i 4/3 sqrt(R_i) d_i^(3/2)``, with the tilted depths d_i.

    Attributes
    ----------
    depth : ndarray, (k, m)
        Indentations of the asperities before the tilt [mm], negative where open.
    radius : ndarray, (m,)
        R of the asperities [mm].
    lift : ndarray, (t, m)
        By which each tilt raises the places [mm].
    scale, rate : ndarray, (k,)
        Factor [1/mm^2] and dA0/d(P/E*) [-].
    """

    depth: FloatArray
    radius: FloatArray
    lift: FloatArray
    scale: FloatArray
    rate: FloatArray

    def swapped(self, i: int, j: int) -> Tilted:
        """Return the forecast with the asperities of two places exchanged."""
        order = np.arange(len(self.radius))
        swap(order, i, j)
        return replace(self, depth=self.depth[:, order], radius=self.radius[order])

    def residual(self) -> FloatArray:
        """Return the residuals, (t k,)."""
        tilted = self._value(self.depth[None] + self.lift[:, None], self.radius)
        return np.asarray((tilted - self._value(self.depth[None], self.radius)).sum(axis=-1).ravel())

    def changes(self, places: IntArray) -> FloatArray:
        """Return their changes by the exchange of each two of the places, (t k, m, m)."""
        # asperity a at place b
        depth = self.depth[:, places]
        tilted = depth[None, :, :, None] + self.lift[:, places][:, None, None, :]
        rows = len(self.lift) * len(self.depth)
        value = self._value(tilted, self.radius[places][:, None]).reshape(rows, len(places), -1)
        own = np.diagonal(value, axis1=1, axis2=2)
        return np.asarray(value + value.transpose(0, 2, 1) - own[:, :, None] - own[:, None, :])

    def _value(self, depth: FloatArray, radius: FloatArray) -> FloatArray:
        deep = np.maximum(depth, 0.0)
        tail = (1,) * (depth.ndim - 2)
        scale, rate = self.scale.reshape(-1, *tail), self.rate.reshape(-1, *tail)
        load = Hertz().load_at_indentation(deep, radius)
        return np.asarray(scale * (math.pi * radius * deep - rate * load))


@dataclass(frozen=True, eq=False)
class Joined:
    """Several forecasts, each times a factor."""

    factors: tuple[float, ...]
    parts: tuple[Forecast, ...]

    def swapped(self, i: int, j: int) -> Joined:
        """Return the forecast with the asperities of two places exchanged."""
        return replace(self, parts=tuple(part.swapped(i, j) for part in self.parts))

    def residual(self) -> FloatArray:
        """Return the residuals, (q,)."""
        return np.concatenate([f * part.residual() for f, part in zip(self.factors, self.parts, strict=True)])

    def changes(self, places: IntArray) -> FloatArray:
        """Return their changes by the exchange of each two of the places, (q, m, m)."""
        pairs = zip(self.factors, self.parts, strict=True)
        return np.concatenate([f * part.changes(places) for f, part in pairs])


def exchanged(
    forecast: Forecast,
    missed: FloatArray,
    order: IntArray,
    open_: IntArray,
    most: int,
    rng: np.random.Generator,
) -> IntArray:
    """Return the order after at most `most` exchanges, each the best of all for the sum of squares.

    forecast: of the asperities in the given order; missed: what it misses (q,), taken as constant; open_:
    the places that take part.
    """
    order, now = order.copy(), forecast
    residual = now.residual() + missed
    for _ in range(most):
        if residual @ residual <= ENOUGH**2:
            break
        places = drawn(open_, rng)
        change = now.changes(places)
        squares = after(residual, change)
        a, b = np.unravel_index(int(squares.argmin()), squares.shape)
        if not squares[a, b] < residual @ residual * (1.0 - LEAST_GAIN):
            break
        residual = residual + change[:, a, b]
        i, j = int(places[a]), int(places[b])
        swap(order, i, j)
        now = now.swapped(i, j)
    return order


def after(residual: FloatArray, change: FloatArray) -> FloatArray:
    """Return the sum of squares after each exchange, (m, m)."""
    flat = change.reshape(len(residual), -1)
    squares = (flat * flat).sum(axis=0) + 2.0 * (residual @ flat) + residual @ residual
    return np.asarray(squares.reshape(change.shape[1:]))


def drawn(places: IntArray, rng: np.random.Generator) -> IntArray:
    """Return the places among which exchanges are priced."""
    if len(places) <= PRICED_AT_ONCE:
        return places
    return np.asarray(rng.choice(places, PRICED_AT_ONCE, replace=False))


def swap(order: IntArray, i: int, j: int) -> None:
    """Exchange two entries in place."""
    order[i], order[j] = order[j], order[i]
