"""Exchanges of asperities between places, by a forecast that prices all of them at once.

To first order in the interaction a change of A0 is a quadratic form in what the asperities carry and how
they weigh, each at its place; that by a tilt is a sum over the places. Exchanging two asperities changes
both by terms of the two places alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from metafem._validate import FloatArray, IntArray

# Places among which all exchanges are priced in one step; of more places, so many are drawn at random.
PRICED_AT_ONCE = 96

# A gain below this share of the sum of squares is rounding.
LEAST_GAIN = 1e-9


class Forecast(Protocol):
    """Residuals (q,) of asperities in their places."""

    def placed(self, order: IntArray) -> Forecast:
        """Return the forecast with asperity order[i] at place i."""
        ...

    def residual(self) -> FloatArray:
        """Return the residuals, (q,)."""
        ...

    def changes(self, places: IntArray) -> FloatArray:
        """Return their changes by the exchange of each two of the places, (q, m, m)."""
        ...


@dataclass(frozen=True, eq=False)
class Coupled:
    """``base + sum_ij left_i G_ij right_j``: left and right (q, n) move with the asperities."""

    base: FloatArray
    left: FloatArray
    right: FloatArray
    influence: FloatArray

    def placed(self, order: IntArray) -> Coupled:
        """Return the forecast with asperity order[i] at place i."""
        return replace(self, left=self.left[:, order], right=self.right[:, order])

    def residual(self) -> FloatArray:
        """Return the residuals, (q,)."""
        return np.asarray(self.base + ((self.left @ self.influence) * self.right).sum(axis=1))

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
        change += left * difference(self.right @ self.influence)
        change += right * difference(self.left @ self.influence)
        return np.asarray(-change)


@dataclass(frozen=True, eq=False)
class Tilted:
    """Relative changes of A0 by tilts of independent asperities, at fixed load.

    The load that a tilt adds at a fixed separation is given back along the law,
    ``dA = sum_i pi R_i d_i - dA0/dP sum_i 4/3 sqrt(R_i) d_i^(3/2)``, with the tilted depths d_i.

    Attributes
    ----------
    depth : ndarray, (k, n)
        Indentations of the asperities before the tilt [mm], negative where open.
    radius : ndarray, (n,)
        R of the asperities [mm].
    lift : ndarray, (t, n)
        By which each tilt raises the places [mm].
    scale, rate : ndarray, (k,)
        Factor [1/mm^2] and dA0/d(P/E*) [-].
    """

    depth: FloatArray
    radius: FloatArray
    lift: FloatArray
    scale: FloatArray
    rate: FloatArray

    def placed(self, order: IntArray) -> Tilted:
        """Return the forecast with asperity order[i] at place i."""
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
        return np.asarray(scale * deep * (math.pi * radius - rate * (4.0 / 3.0) * np.sqrt(radius * deep)))


@dataclass(frozen=True, eq=False)
class Joined:
    """Several forecasts, each times a factor."""

    factors: tuple[float, ...]
    parts: tuple[Forecast, ...]

    def placed(self, order: IntArray) -> Joined:
        """Return the forecast with asperity order[i] at place i."""
        return replace(self, parts=tuple(part.placed(order) for part in self.parts))

    def residual(self) -> FloatArray:
        """Return the residuals, (q,)."""
        return np.concatenate([f * part.residual() for f, part in zip(self.factors, self.parts, strict=True)])

    def changes(self, places: IntArray) -> FloatArray:
        """Return their changes by the exchange of each two of the places, (q, m, m)."""
        pairs = zip(self.factors, self.parts, strict=True)
        return np.concatenate([f * part.changes(places) for f, part in pairs])


def exchanged(
    forecast: Forecast, missed: FloatArray, order: IntArray, most: int, rng: np.random.Generator
) -> IntArray:
    """Return the order after at most `most` exchanges, each the best of all for the sum of squares.

    missed: what the forecast misses (q,), taken as constant.
    """
    order = order.copy()
    now = forecast.placed(order)
    residual = now.residual() + missed
    for _ in range(most):
        places = drawn(len(order), rng)
        change = now.changes(places)
        squares = after(residual, change)
        a, b = np.unravel_index(int(squares.argmin()), squares.shape)
        if not squares[a, b] < residual @ residual * (1.0 - LEAST_GAIN):
            break
        residual = residual + change[:, a, b]
        swap(order, int(places[a]), int(places[b]))
        now = forecast.placed(order)
    return order


def after(residual: FloatArray, change: FloatArray) -> FloatArray:
    """Return the sum of squares after each exchange, (m, m)."""
    flat = change.reshape(len(residual), -1)
    squares = (flat * flat).sum(axis=0) + 2.0 * (residual @ flat) + residual @ residual
    return np.asarray(squares.reshape(change.shape[1:]))


def drawn(count: int, rng: np.random.Generator) -> IntArray:
    """Return the places among which exchanges are priced."""
    if count <= PRICED_AT_ONCE:
        return np.arange(count)
    return np.asarray(rng.choice(count, PRICED_AT_ONCE, replace=False))


def swap(order: IntArray, i: int, j: int) -> None:
    """Exchange two entries in place."""
    order[i], order[j] = order[j], order[i]
