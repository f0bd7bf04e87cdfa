"""Layers of finite thickness: their influence as an integral over wavenumbers, tabulated in r/t."""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Callable

import numpy as np
from scipy.special import j0, j1

from metafem._kernels import layer as kernel
from metafem._validate import FloatArray
from metafem.substrate.radial import Radial

# Upper limit of the integrals. Beyond it 1 - M, which decreases at most as x^2 exp(-2x), is below 1e-19.
LAST_WAVENUMBER = 25.0

# Number of panels and of Gauss points per panel. A panel is shorter than three periods of J0 at the end of
# the longest table.
PANELS = 72
PANEL_POINTS = 16

# Nodes x and weights w for which sum w f(x) is the integral of (1 - M) f.
Quadrature = tuple[FloatArray, FloatArray]


class Layered(Radial):
    """Base of substrates with ``G(r) = 1/pi int_0^inf M(k t) J0(k r) dk`` and a thickness t.

    ``M(x)`` tends to 1 for large x, so that G is that of a half-space near the source.

    Examples
    --------
    >>> from metafem import BondedLayer
    >>> issubclass(BondedLayer, Layered)
    True
    """

    @property
    @abstractmethod
    def _thickness(self) -> float:
        """Thickness t [mm]; raises InvalidInput if it is not known."""

    @property
    @abstractmethod
    def _quadrature(self) -> Quadrature:
        """Nodes and weights of integrals with 1 - M."""

    @property
    @abstractmethod
    def _table(self) -> FloatArray:
        """Coefficients of the regular part for `metafem._kernels.layer`."""

    @property
    @abstractmethod
    def _mean(self) -> float:
        """Displacement by a uniform pressure p/E* = 1 [mm]."""

    @abstractmethod
    def _deficit(self, wavenumber: FloatArray) -> FloatArray:
        """Return 1 - M at wavenumbers x = k t [-]."""

    @property
    def self_influence(self) -> float:
        """Regular part of G at r = 0, ``-1/(pi t) int (1 - M) dx`` [1/mm]."""
        thickness, (_, weight) = self._thickness, self._quadrature
        return float(-float(weight.sum()) / (math.pi * thickness))

    @property
    def self_curvature(self) -> float:
        """Second derivative of the regular part at r = 0, ``1/(2 pi t^3) int (1 - M) x^2 dx`` [1/mm^3]."""
        thickness, (x, weight) = self._thickness, self._quadrature
        return float(float(weight @ x**2) / (2.0 * math.pi * thickness**3))

    def regular_derivatives(self, distance: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the regular parts of G [1/mm], G' [1/mm^2] and G'' [1/mm^3] at distances r >= 0 [mm]."""
        thickness = self._thickness
        flat = np.ravel(distance)
        parts = kernel.empty_results(flat.size)
        kernel.fill_regular(flat, thickness, self._table, *parts)
        value, first, second = (part.reshape(np.shape(distance)) for part in parts)
        return value, first, second

    @property
    def last_wavenumber(self) -> float:
        """Wavenumber k beyond which 1 - M(k t) is zero to rounding [1/mm]."""
        return LAST_WAVENUMBER / self._thickness

    def transform(self, wavenumber: FloatArray) -> FloatArray:
        """Return ``2 (M(k t) - 1)/k`` [mm] at wavenumbers k [1/mm], and the mean displacement at k = 0."""
        thickness = self._thickness
        x = np.where(wavenumber > 0.0, wavenumber * thickness, 1.0)
        value = -2.0 * thickness * self._deficit(np.minimum(x, 4.0 * LAST_WAVENUMBER)) / x
        return np.asarray(np.where(wavenumber > 0.0, value, self._mean))


def quadrature(deficit: Callable[[FloatArray], FloatArray]) -> Quadrature:
    """Return the nodes and weights of integrals with 1 - M, for this function of x = k t."""
    node, weight = np.polynomial.legendre.leggauss(PANEL_POINTS)
    half = 0.5 * LAST_WAVENUMBER / PANELS
    x = (half * (2.0 * np.arange(PANELS)[:, None] + 1.0 + node)).ravel()
    return x, half * np.tile(weight, PANELS) * deficit(x)


def regular_table(given: Quadrature, end: float) -> FloatArray:
    """Return the read-only table of the regular part up to s = r/t = `end`."""
    x, weight = given

    def regular(s: FloatArray) -> tuple[FloatArray, ...]:
        phase = np.outer(s, x)
        zero, one = j0(phase), j1(phase)
        return -(zero @ weight), one @ (weight * x), (zero - one / phase) @ (weight * x**2)

    table = kernel.tabulated(regular, end)
    table.flags.writeable = False
    return table
