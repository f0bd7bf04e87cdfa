"""Two equal paraboloids on a half-space without a grid: the least complementary energy of elliptic contacts.

Each pressure is p0 √(1 − x²/a² − y²/b²) about a centre that is shifted by s away from the other. Its own
displacement is Hertz's closed form; the energy of both is an integral of smooth functions. What ellipses
leave out is the cubic part of the other's field, so that the load at a given approach is exact to about its
square, (a/r)⁸.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import minimize
from scipy.special import ellipk

# Points of the quadrature over the radius and the angle; more change nothing at a/r = 0.3.
RADIAL, ANGLES = 10, 24

# Largest gradient of the scaled energy at its minimum.
STATIONARY = 1e-9


def pair(approach: float, radius: float, distance: float) -> tuple[float, float]:
    """Return load P/E* [mm²] and area A0 [mm²] of both under an approach [mm]."""
    wide = np.sqrt(radius * approach)  # of a contact that is alone
    scale = 8.0 / 15.0 * np.sqrt(radius) * approach**2.5  # its energy

    def scaled(unknown: np.ndarray) -> float:
        return _energy(unknown, approach, radius, distance, wide) / scale

    found = minimize(scaled, [2.0 / np.pi, 1.0, 1.0, 0.0], method="BFGS", options={"gtol": STATIONARY})
    if np.abs(found.jac).max() > 1e3 * STATIONARY:
        raise ArithmeticError(f"the energy of two contacts has no minimum to {STATIONARY:g}: {found.message}")
    pressure, a, b, _ = found.x * np.array([wide / radius, wide, wide, wide])
    return float(4.0 / 3.0 * np.pi * a * b * pressure), float(2.0 * np.pi * a * b)


def _energy(unknown: np.ndarray, approach: float, radius: float, distance: float, wide: float) -> float:
    """Complementary energy over E* [mm³] of p0 R/E*, a, b and s in units of a radius."""
    pressure, a, b, shift = unknown * np.array([wide / radius, wide, wide, wide])
    volume = 2.0 / 3.0 * np.pi * a * b
    alone = 0.4 * pressure**2 * volume * min(a, b) * ellipk(1.0 - (min(a, b) / max(a, b)) ** 2)
    gap = ((a**2 + b**2) / 5.0 + shift**2) / (2.0 * radius) - approach
    x, y, weight = _disc()
    first, second = a * x - 0.5 * distance - shift, 0.5 * distance + shift - a * x
    apart = np.hypot(first[:, None] - second, b * (y[:, None] - y))
    both = (a * b * pressure) ** 2 * (weight @ (1.0 / apart) @ weight) / np.pi
    return float(2.0 * (alone + pressure * volume * gap) + both)


def _disc() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of the unit disc and weights of integrals with √(1 − ρ²)."""
    node, weight = np.polynomial.legendre.leggauss(RADIAL)
    root, weight = 0.5 * (node + 1.0), 0.5 * weight  # of √(1 − ρ²), whose differential is -ρ dρ over it
    angle = 2.0 * np.pi * (np.arange(ANGLES) + 0.5) / ANGLES
    rho = np.sqrt(1.0 - root**2)[:, None]
    weights = np.repeat(weight * root**2, ANGLES) * 2.0 * np.pi / ANGLES
    return (rho * np.cos(angle)).ravel(), (rho * np.sin(angle)).ravel(), weights
