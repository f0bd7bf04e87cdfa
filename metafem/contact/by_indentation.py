"""Contact laws with load and area as functions of the indentation, and cubics for these functions."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from metafem._validate import FloatArray, IntArray
from metafem.contact.law import Contact, Values
from metafem.errors import InvalidInput

# Relative excess over the largest indentation that is treated as rounding.
ROUNDING = 1e-12

# Maximum number of steps of Newton's method with bisection in one panel; the cubics of contact laws need 3 to
# 6. Convergence is quadratic: after a step below SETTLED, the next step is below rounding.
MOST_STEPS, SETTLED = 60, 1e-9


class LawByIndentation(Contact):
    """Contact law with load P/E* and area A as functions of the indentation d; its coupling is of order 1.

    The contact radius is ``sqrt(A/pi)``. The law ignores the curvature due to other contacts, which is a term
    of order 3.
    """

    if TYPE_CHECKING:  # members of the subclasses whose load and area are `LogCubic`

        @property
        def _load(self) -> LogCubic:
            """P/E* as a function of d, in the units of `_scales`."""

        @property
        def _area(self) -> LogCubic:
            """A as a function of d, in the units of `_scales`."""

    @abstractmethod
    def _scales(self, radius: Any) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the units of d [mm], P/E* [mm^2] and A [mm^2]."""

    def _scaled_load(self, d: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return P/E* and d ln P/d ln d [-] at d, with P/E* and d in the units of `_scales`."""
        return self._load.at(d)

    def _load_at(self, depth: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return P/E* [mm^2] and its derivative [mm] at indentations depth > 0 [mm]."""
        length, unit, _ = self._scales(radius)
        scaled, slope = self._scaled_load(depth / length)
        load = unit * scaled
        return load, load * slope / depth

    def _area_at(self, depth: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return A [mm^2] and its derivative [mm] at indentations depth > 0 [mm]."""
        length, _, unit = self._scales(radius)
        scaled, slope = self._area.at(depth / length)
        area = unit * scaled
        return area, area * slope / depth

    def _depth_at(self, area: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the indentation d [mm] at areas > 0 [mm^2]."""
        length, _, unit = self._scales(radius)
        return np.asarray(length * self._area.inverse(area / unit))

    def breaks(self, radius: float) -> FloatArray:
        """Return the contact radii [mm] at the ends of the panels of A(d)."""
        _, _, unit = self._scales(radius)
        return np.asarray(np.sqrt(unit * np.exp(self._area.y) / math.pi))

    def contact_radius(self, indentation: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the contact radius sqrt(A/pi) [mm]; 0 where the contact is open."""
        given = (np.asarray(value, dtype=np.float64) for value in (indentation, radius))
        d, size = np.broadcast_arrays(*given)
        most = self.largest_indentation(size)
        deep = d > most * (1.0 + ROUNDING)
        if deep.any():
            first = np.unravel_index(int(np.argmax(deep)), d.shape)
            raise InvalidInput(
                f"indentation = {d[first]:.4g} mm exceeds {most[first]:.4g} mm, the largest that {self!r} "
                "describes; use lighter loads or a law with a larger range"
            )
        closed = d > 0.0
        area, _ = self._area_at(np.where(closed, d, 1.0), size)
        return np.asarray(np.where(closed, np.sqrt(area / math.pi), 0.0))[()]

    def indentation(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the indentation d [mm]."""
        return self._of_closed(lambda depth, _: (depth,), contact_radius, radius)[0]

    def load(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return the rescaled load P/E* [mm^2]."""
        return self._of_closed(self._load_at, contact_radius, radius)[0]

    def stiffness(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return d(P/E*)/dd [mm]; 0 for an open contact."""
        return self._of_closed(self._load_at, contact_radius, radius)[1]

    def area_slope(self, contact_radius: Values, radius: Values, curvature: Values = 0.0) -> FloatArray:
        """Return dA/dd [mm]; 0 for an open contact."""
        return self._of_closed(self._area_at, contact_radius, radius)[1]

    def _of_closed(
        self, function: Callable[..., tuple[FloatArray, ...]], contact_radius: Values, radius: Values
    ) -> list[FloatArray]:
        """Return the values of a function of indentation and summit radius; 0 for open contacts."""
        given = (np.asarray(value, dtype=np.float64) for value in (contact_radius, radius))
        a, size = np.broadcast_arrays(*given)
        closed = a > 0.0
        depth = self._depth_at(math.pi * np.where(closed, a, 1e-3 * size) ** 2, size)
        return [np.asarray(np.where(closed, value, 0.0))[()] for value in function(depth, size)]


class LogCubic(NamedTuple):
    """An increasing function y(x) of x > 0 with a continuous slope.

    ln y is a cubic polynomial of ln x in each panel. Outside the panels ln y is a straight line, so that y is
    a power of x. Power laws are reproduced exactly.
    """

    x: FloatArray  # (m,), ln x at the ends of the panels, increasing
    y: FloatArray  # (m,), ln y there, increasing
    slope: FloatArray  # (m,), d ln y/d ln x there, positive

    @classmethod
    def powers(cls, parts: list[tuple[float, float]], blends: list[tuple[float, float]]) -> LogCubic:
        """Return the power laws ``c x^n`` of parts (c, n), joined by a cubic over each blend (start, end)."""
        ends = np.log(np.array(blends))
        scale = np.log([c for c, _ in parts])
        power = np.array([n for _, n in parts])
        y = np.stack([scale[:-1] + power[:-1] * ends[:, 0], scale[1:] + power[1:] * ends[:, 1]], axis=1)
        slope = np.stack([power[:-1], power[1:]], axis=1)
        return cls(ends.ravel(), y.ravel(), slope.ravel())

    def at(self, x: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return y and d ln y/d ln x at x > 0."""
        u = np.log(x)
        panel = self._panel(self.x, u)
        y, slope = self._in_panel(panel, (u - self.x[panel]) / (self.x[panel + 1] - self.x[panel]))
        return np.exp(y), slope

    def inverse(self, y: FloatArray) -> FloatArray:
        """Return x at y > 0, to rounding."""
        v = np.log(y)
        panel = self._panel(self.y, v)
        width = self.x[panel + 1] - self.x[panel]
        t = (v - self.y[panel]) / (self.y[panel + 1] - self.y[panel])
        before, after = t < 0.0, t > 1.0
        t = np.where(before, (v - self.y[panel]) / (self.slope[panel] * width), t)
        t = np.where(after, 1.0 + (v - self.y[panel + 1]) / (self.slope[panel + 1] * width), t)
        inside = ~(before | after)
        low, high = np.where(inside, 0.0, t), np.where(inside, 1.0, t)
        for _ in range(MOST_STEPS):
            found, slope = self._in_panel(panel, t)
            low, high = np.where(found <= v, t, low), np.where(found >= v, t, high)
            new = t - (found - v) / (slope * width)
            new = np.where((new >= low) & (new <= high), new, 0.5 * (low + high))
            settled = np.abs(new - t) <= SETTLED
            t = np.where(inside, new, t)
            if (settled | ~inside).all():
                break
        return np.exp(self.x[panel] + width * t)

    def _panel(self, ends: FloatArray, values: FloatArray) -> IntArray:
        """Return the panel index of each value; values outside get the first or the last panel."""
        return np.clip(np.searchsorted(ends, values, side="right") - 1, 0, len(ends) - 2).astype(np.int64)

    def _in_panel(self, panel: IntArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return ln y and d ln y/d ln x at t, which runs from 0 to 1 in a panel; outside, ln y is linear."""
        width = self.x[panel + 1] - self.x[panel]
        left, right = self.slope[panel], self.slope[panel + 1]
        mean = (self.y[panel + 1] - self.y[panel]) / width
        s = np.clip(t, 0.0, 1.0)
        # Hermite cubic: a line with the left slope, plus two corrections that vanish for a power law
        square, cube = 3.0 * mean - 2.0 * left - right, left + right - 2.0 * mean
        y = self.y[panel] + width * s * (left + s * (square + s * cube))
        slope = left + s * (2.0 * square + 3.0 * s * cube)
        return y + width * (t - s) * slope, slope
