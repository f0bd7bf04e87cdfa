"""Closed forms of one elastic contact: powers of the distance, and spheres.

All loads are P/E* [mm^2], stiffnesses are divided by E* [mm], lengths are in mm. A cap ``f = c R (rho/R)^n``
that touches over the radius a has the indentation ``d = k a^n`` and the load ``2n/(n+1) a d``, with
``k = c R^(1-n) sqrt(pi) Gamma(n/2 + 1)/Gamma((n + 1)/2)``; a sphere has ``d = a artanh(a/R)`` and
``P = (a^2 + R^2) artanh(a/R) - a R`` (Sneddon). The stiffness of every elastic contact is 2 a.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

# Newton steps for the contact radius of a sphere, which converge from above for every indentation.
SPHERE_STEPS = 60


@dataclass(frozen=True)
class Tool:
    """A shape that asperities can have: a sphere, or ``f = coefficient R (rho/R)^exponent``."""

    radius: float
    exponent: float = 2.0
    coefficient: float = 0.5
    sphere: bool = False

    @property
    def factor(self) -> float:
        """Factor k of ``d = k a^n``."""
        n = self.exponent
        gamma = math.sqrt(math.pi) * math.gamma(0.5 * n + 1.0) / math.gamma(0.5 * (n + 1.0))
        return self.coefficient * self.radius ** (1.0 - n) * gamma


@dataclass(frozen=True)
class Caps:
    """The caps of asperities as arrays of any one shape (..., n)."""

    radius: np.ndarray
    exponent: np.ndarray
    factor: np.ndarray  # k of d = k a^n
    sphere: np.ndarray

    @classmethod
    def of(cls, tools: tuple[Tool, ...], index: np.ndarray) -> Caps:
        """Return the caps of asperities whose tools have these numbers, counted from 0."""
        table = np.array([(t.radius, t.exponent, t.factor, t.sphere) for t in tools])
        radius, exponent, factor, sphere = np.moveaxis(table[index], -1, 0)
        return cls(radius, exponent, factor, sphere > 0.0)

    def pressed(self, indentation: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return contact radii [mm] and loads [mm^2] at indentations [mm]; both are 0 if not positive."""
        d = np.maximum(indentation, 0.0)
        n = self.exponent
        a = (d / self.factor) ** (1.0 / n)
        load = 2.0 * n / (n + 1.0) * a * d
        if self.sphere.any():
            ball, ball_load = _sphere(d, self.radius)
            a, load = np.where(self.sphere, ball, a), np.where(self.sphere, ball_load, load)
        return a, load


def _sphere(d: np.ndarray, radius: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return contact radii and loads of spheres, by Newton's method from above: artanh x >= x."""
    x = np.minimum(np.sqrt(d / radius), 1.0 - 1e-15)
    for _ in range(SPHERE_STEPS):
        slope = np.arctanh(x) + x / ((1.0 - x) * (1.0 + x))
        step = np.where(x > 0.0, (x * np.arctanh(x) - d / radius) / np.where(x > 0.0, slope, 1.0), 0.0)
        x = np.clip(x - step, 0.0, 1.0 - 1e-15)
        if np.abs(step).max() < 1e-16:
            break
    return radius * x, radius**2 * ((x**2 + 1.0) * np.arctanh(x) - x)
