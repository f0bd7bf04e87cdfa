"""Increasing functions whose logarithm is a piecewise cubic of the logarithm."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from metafem._validate import FloatArray, IntArray

# Newton's method and bisection in one panel; the cubics of contact laws need 3 to 6. After a step below
# SETTLED the next one, its square, is below rounding.
MOST_STEPS, SETTLED = 60, 1e-9


class LogCubic(NamedTuple):
    """An increasing function y(x) of x > 0, continuous with its slope.

    ln y is a cubic of ln x in each panel and a straight line, a power of x, outside the panels. A panel whose
    ends lie on a straight line of their slopes is that line: powers are exact.
    """

    x: FloatArray  # (m,), ln x at the ends of the panels, increasing
    y: FloatArray  # (m,), ln y there, increasing
    slope: FloatArray  # (m,), d ln y/d ln x there, positive

    @classmethod
    def powers(cls, parts: list[tuple[float, float]], blends: list[tuple[float, float]]) -> LogCubic:
        """Return the function ``c x^n`` of parts (c, n), joined by cubics over blends (from, to)."""
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
        """Return the panels of values, the first or the last one for values outside."""
        return np.clip(np.searchsorted(ends, values, side="right") - 1, 0, len(ends) - 2).astype(np.int64)

    def _in_panel(self, panel: IntArray, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return ln y and its slope at t in panels, from 0 to 1; outside on straight lines."""
        width = self.x[panel + 1] - self.x[panel]
        left, right = self.slope[panel], self.slope[panel + 1]
        mean = (self.y[panel + 1] - self.y[panel]) / width
        s = np.clip(t, 0.0, 1.0)
        # Hermite's cubic as the straight line of the left slope and two corrections, which vanish for a line
        square, cube = 3.0 * mean - 2.0 * left - right, left + right - 2.0 * mean
        y = self.y[panel] + width * s * (left + s * (square + s * cube))
        slope = left + s * (2.0 * square + 3.0 * s * cube)
        return y + width * (t - s) * slope, slope
