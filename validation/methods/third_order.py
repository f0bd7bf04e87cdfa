"""Equilibrium of interacting caps to third order: the equations in numpy, solved by a general root finder.

For caps ``f = rho^n/(2 R^(n - 1))``, the paraboloid for n = 2, on a half-space or a bonded layer; all
contacts are closed, loads are P/E*.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root
from scipy.special import beta, j0, j1

FloatArray = NDArray[np.float64]

# Quadrature of a layer: M - 1 is below 1e-15 beyond this argument.
LAST, POINTS = 20.0, 400


def multiplier(x: FloatArray, ratio: float) -> FloatArray:
    """M(x) of a layer on a rigid base; Johnson, Contact Mechanics (1985), section 5.8."""
    k = 3.0 - 4.0 * ratio
    return (2.0 * k * np.sinh(2.0 * x) - 4.0 * x) / (2.0 * k * np.cosh(2.0 * x) + 4.0 * x**2 + 1.0 + k**2)


class Fields(NamedTuple):
    """Influence of the contacts on each other, its two slopes and its Laplacian, (n, n) with self terms."""

    influence: FloatArray  # [1/mm]
    slope: FloatArray  # (2, n, n) [1/mm²]
    laplacian: FloatArray  # [1/mm³]


def fields(position: FloatArray, layer: tuple[float, float] | None = None) -> Fields:
    """Return the fields of point loads at positions (n, 2) [mm]; layer: its thickness [mm] and nu."""
    apart = np.moveaxis(position[:, None] - position, -1, 0)
    r = np.hypot(*apart) + np.eye(len(position))  # the diagonal is set below
    point = 1.0 - np.eye(len(position))
    value, first, laplacian = point / (np.pi * r), -point / (np.pi * r**2), point / (np.pi * r**3)
    if layer is not None:
        thickness, ratio = layer
        node, weight = np.polynomial.legendre.leggauss(POINTS)
        x = 0.5 * LAST * (node + 1.0)
        weight = 0.5 * LAST * weight * (multiplier(x, ratio) - 1.0) / np.pi
        s = np.multiply.outer(np.hypot(*apart) / thickness, x)
        value = value + j0(s) @ weight / thickness
        first = first - j1(s) @ (x * weight) / thickness**2
        laplacian = laplacian - j0(s) @ (x**2 * weight) / thickness**3
    return Fields(value, first * apart / r, laplacian)


class Caps(NamedTuple):
    """Caps of an exponent n and radii R (k,) [mm]."""

    radius: FloatArray
    exponent: float = 2.0

    def depth(self, a: FloatArray) -> FloatArray:
        """Indentation of a cap alone, ``n a int_0^a rho^(n - 1)/sqrt(a² - rho²) drho/(2 R^(n - 1))``."""
        n = self.exponent
        # B(n/2, 1/2)/2 is int_0^1 t^(n - 1)/sqrt(1 - t²) dt
        return 0.5 * n * beta(0.5 * n, 0.5) * a**n / (2.0 * self.radius ** (n - 1.0))

    def load(self, a: FloatArray) -> FloatArray:
        """Load of a cap alone, the sum of flat punches 2 s dD(s)."""
        return 2.0 * a * self.depth(a) * self.exponent / (self.exponent + 1.0)

    def moment(self, a: FloatArray) -> FloatArray:
        """Second moment of its pressure, that of flat punches 4/3 s³ dD(s)."""
        return 4.0 / 3.0 * a**3 * self.depth(a) * self.exponent / (self.exponent + 3.0)

    def radius_at(self, load: FloatArray) -> FloatArray:
        """Contact radius of a cap alone at a load."""
        one = np.ones_like(load)
        return np.asarray((load / self.load(one)) ** (1.0 / (self.exponent + 1.0)))


class _State(NamedTuple):
    """Contacts of given radii."""

    load: FloatArray  # [mm²]
    depth: FloatArray  # indentations plus displacements by the others [mm]
    square: FloatArray  # areas over pi [mm²]


def _state(caps: Caps, on: Fields, a: FloatArray) -> _State:
    """Return the contacts of radii a."""
    n = caps.exponent
    # the curvature k = L p/2 by the others adds 4/3 k a³ to the load
    flat = np.eye(len(a)) - 2.0 / 3.0 * a[:, None] ** 3 * on.laplacian
    p = np.linalg.solve(flat, caps.load(a))
    k, slope = 0.5 * on.laplacian @ p, on.slope @ p
    steep, wide = (slope**2).sum(axis=0), n * caps.depth(a) + 2.0 * k * a**2  # |g|², a dD/da
    # the contact moves down the slope: a cap alone with the same load of the cap
    own = caps.radius_at(caps.load(a) + 4.0 / 3.0 * k * a**3)
    turn = 2.0 * own**2 / (n * caps.depth(own))  # r = 2 a/(dD/da)
    moment = caps.moment(a) + 8.0 / 15.0 * k * a**5
    moved = np.einsum("cji,cj->i", on.slope, 4.0 / 3.0 * own**3 * slope)
    u = on.influence @ p + 0.25 * on.laplacian.T @ moment - moved - 0.5 * turn * steep
    # the edge on a slope follows from that of adhesive contacts in the limit w = 0
    y = n * (n - 2.0) * caps.depth(a) * a**2 * steep / wide**3
    square = a**2 / np.sqrt(1.0 + 4.0 * y) if n > 2.0 else a**2 * (1.0 - 2.0 * y)
    return _State(p, caps.depth(a) + k * a**2 + u, square)


def solved(caps: Caps, on: Fields, gap: FloatArray, load: float) -> tuple[float, FloatArray]:
    """Return the approach [mm] at which contacts of gaps (n,) carry a load, and the roots of A/pi [mm]."""
    start = caps.radius_at(np.full(len(gap), load / len(gap)))

    def equations(unknown: FloatArray) -> FloatArray:
        state = _state(caps, on, unknown[:-1])
        return np.append(state.depth - (unknown[-1] - gap), (state.load.sum() - load) / start.mean())

    first = np.append(start, float((caps.depth(start) + gap).mean()))
    found = root(equations, first, tol=1e-14)
    if np.abs(found.fun).max() > 1e-12:
        raise ArithmeticError(f"the equations of third order are not solved: {found.message}")
    return float(found.x[-1]), np.sqrt(_state(caps, on, found.x[:-1]).square)
