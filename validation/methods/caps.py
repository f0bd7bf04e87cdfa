"""Closed forms of elastic contacts of powers of the distance and of spheres, and sums of independent ones.

Loads are P/E* [mm²], lengths are in mm. A cap ``f = c R (rho/R)^n`` that touches over the radius a has the
indentation ``d = k a^n`` and the load ``2n/(n+1) a d``, with
``k = c R^(1-n) sqrt(pi) Gamma(n/2 + 1)/Gamma((n + 1)/2)``; a sphere has ``d = a artanh(a/R)`` and
``P = (a² + R²) artanh(a/R) - a R`` (Sneddon). The stiffness of every elastic contact is 2 a.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import gamma

FloatArray = NDArray[np.float64]

# Newton steps for the contact radius of a sphere, which converge from above for every indentation; largest
# number of steps for the approach, and the relative error of the load at which they end.
SPHERE_STEPS, STEPS, ROUNDING = 60, 200, 4e-15


class Caps(NamedTuple):
    """Caps of asperities (n,): spheres, or ``f = coefficient R (rho/R)^exponent``."""

    radius: ArrayLike
    exponent: ArrayLike = 2.0
    coefficient: ArrayLike = 0.5
    sphere: ArrayLike = False

    def pressed(self, indentation: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return contact radii [mm] and loads [mm²] at indentations [mm]; both are 0 if not positive."""
        d, n, radius = np.maximum(indentation, 0.0), np.asarray(self.exponent), np.asarray(self.radius)
        k = np.sqrt(np.pi) * gamma(0.5 * n + 1.0) / gamma(0.5 * (n + 1.0))
        a = (d / (self.coefficient * radius ** (1.0 - n) * k)) ** (1.0 / n)
        load = 2.0 * n / (n + 1.0) * a * d
        if np.any(self.sphere):
            ball, ball_load = _sphere(d, radius)
            a, load = np.where(self.sphere, ball, a), np.where(self.sphere, ball_load, load)
        return a, load


def _sphere(d: FloatArray, radius: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return contact radii and loads of spheres, by Newton's method from above: artanh x >= x."""
    x = np.minimum(np.sqrt(d / radius), 1.0 - 1e-15)
    for _ in range(SPHERE_STEPS):
        slope = np.arctanh(x) + x / ((1.0 - x) * (1.0 + x))
        step = np.where(x > 0.0, (x * np.arctanh(x) - d / radius) / np.where(x > 0.0, slope, 1.0), 0.0)
        x = np.clip(x - step, 0.0, 1.0 - 1e-15)
        if np.abs(step).max() < 1e-16:
            break
    return radius * x, radius**2 * ((x**2 + 1.0) * np.arctanh(x) - x)


def approach_at(caps: Caps, height: FloatArray, load: float) -> float:
    """Return the approach [mm] at which independent asperities carry a load.

    The total load is a convex function of the approach, so Newton's method converges from above.
    """
    gap, approach = height.max() - height, 1e-3
    while caps.pressed(approach - gap)[1].sum() < load:
        approach *= 2.0
    for _ in range(STEPS):
        a, each = caps.pressed(approach - gap)
        step = (each.sum() - load) / (2.0 * a.sum())
        if step <= ROUNDING * approach:
            break
        approach -= step
    return float(approach)


def areas(caps: Caps, height: FloatArray, load: FloatArray) -> FloatArray:
    """Return A0 (k,) [mm²] of independent asperities of heights (n,) [mm] at loads (k,)."""
    depth = [approach_at(caps, height, each) - (height.max() - height) for each in load.tolist()]
    return np.array([np.pi * (caps.pressed(each)[0] ** 2).sum() for each in depth])
