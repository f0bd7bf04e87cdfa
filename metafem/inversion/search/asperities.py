"""Unknowns of a search for heights and, for each asperity, its radius, its exponent or its tool."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.special import digamma, gammaln

from metafem._validate import FloatArray, IntArray
from metafem.contact.law import contacts
from metafem.errors import InvalidInput
from metafem.inversion.search.spaces import Heights, LateResidual, Residual, moved
from metafem.inversion.search.target_law import TargetLaw
from metafem.inversion.tools.radii import Radii
from metafem.inversion.tools.ranges import PowerRange
from metafem.models import Independent, Sensitivity

# Relative step of finite differences with respect to the radius: the cube root of machine precision.
RELATIVE = 6e-6

# Maximum number of Newton steps, each of which reduces the error by 1/(n + 1) at least; and the relative step
# after which the next one is below rounding.
MOST_NEWTON, SETTLED = 200, 1e-9

# Probabilities that the radius, exponent or tool of an asperity changes; each random change uses one of them
# at random.
NEW_SHAPE = (0.0, 0.1, 0.3)


def beyond(load: FloatArray, height: FloatArray) -> LateResidual:
    """Return infinite differences (k,) for heights beyond the range of the contact law."""
    return np.full(len(load), np.inf), lambda: np.zeros((len(load), len(height)))


def power_logarithms(
    exponent: FloatArray, coefficient: float, radius: float
) -> tuple[FloatArray, FloatArray]:
    """Return ln b of the contact radii ``a = b d^(1/n)`` of power caps, and its derivative with respect to n.

    With K as in `metafem.caps.Power`, ``b = R (c K R)^(-1/n)``.
    """
    n = exponent
    depth = math.log(coefficient * radius * math.sqrt(math.pi)) + gammaln(0.5 * n + 1.0)
    depth -= gammaln(0.5 * (n + 1.0))  # ln(c K R)
    turn = 0.5 * (digamma(0.5 * n + 1.0) - digamma(0.5 * (n + 1.0)))  # K'/K
    return math.log(radius) - depth / n, (depth / n - turn) / n


def _halves(unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
    count = len(unknowns) // 2
    return unknowns[:count], unknowns[count:]


@dataclass(frozen=True, kw_only=True)
class Asperities(Heights):
    """Unknowns of a search: the heights (n,), followed by a number (n,) for the shape of each cap.

    The numbers are lengths, such that equal changes of both kinds of unknowns change the law about equally.
    There are at most `most` asperities, with heights within `span` [mm].
    """

    def joined(self, height: FloatArray, shape: FloatArray) -> FloatArray:
        """Return the unknowns (2n,) for heights [mm] and shapes, (n,) each."""
        raise NotImplementedError

    def split(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the heights [mm] and the allowed shapes for unknowns (2n,), (n,) each."""
        raise NotImplementedError

    def residual(self, model: Independent, target: TargetLaw) -> Residual:
        """Return the residual of independent asperities as a function of the unknowns."""
        raise NotImplementedError

    def _drawn(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return random shapes (count,)."""
        raise NotImplementedError

    def project(self, unknowns: FloatArray) -> FloatArray:
        """Return the nearest unknowns within the limits, (2n,) [mm]."""
        height, shape = self.split(unknowns)
        return self.joined(np.maximum(height, height.max() - self.span), shape)

    def ends(self, unknowns: FloatArray) -> tuple[int, IntArray]:
        """Return the index of the tallest height, and the indices of the heights `span` below it, (m,)."""
        return super().ends(unknowns[: len(unknowns) // 2])

    def changed(self, unknowns: FloatArray, rng: np.random.Generator, sizes: tuple[float, ...]) -> FloatArray:
        """Return unknowns after random changes of some heights and some shapes."""
        height, shape = self.split(unknowns)
        height, source = moved(height, self.most, rng, sizes, self.span)
        anew = rng.random(len(height)) < rng.choice(NEW_SHAPE)
        return self.joined(height, np.where(anew, self._drawn(rng, len(height)), shape[source]))


@dataclass(frozen=True, kw_only=True)
class OfRadii(Asperities):
    """Heights and radii: the second unknowns are ``depth ln R``, where `depth` is the largest indentation.

    Radii that must be those of tools change only in random changes.
    """

    radii: Radii
    depth: float

    def joined(self, height: FloatArray, shape: FloatArray) -> FloatArray:
        """Return the unknowns (2n,) [mm] for heights and radii, (n,) each [mm]."""
        return np.concatenate([height, self.depth * np.log(shape)])

    def split(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the heights and the allowed radii for unknowns (2n,), (n,) each [mm]."""
        height, logarithm = _halves(unknowns)
        return height, self.radii.nearest(np.exp(logarithm / self.depth))

    def _drawn(self, rng: np.random.Generator, count: int) -> FloatArray:
        if self.radii.tools is None:
            return np.exp(rng.uniform(math.log(self.radii.low), math.log(self.radii.high), count))
        return rng.choice(np.array(self.radii.tools), count)

    def residual(self, model: Independent, target: TargetLaw) -> Residual:
        """Return the residual of independent asperities as a function of the unknowns.

        At a fixed load, ``R_i dA0/dR_i = R dA_i/dR - R dP_i/dR sum A' / sum P'`` with the derivatives A' and
        P' with respect to the indentation d. If the contact law scales with R, ``R dA/dR = 2 A - d A'`` at a
        fixed d, and the same relation holds for P. Otherwise finite differences are used.
        """
        law = model.contact

        def residual(unknowns: FloatArray) -> LateResidual:
            height, radius = self.split(unknowns)
            found = model.sensitivity_of(height, radius, target.load)
            return target.late_residual(found.curve.area, lambda: gradient(found, radius))

        def gradient(found: Sensitivity, radius: FloatArray) -> FloatArray:
            depth = found.indentation
            size = np.broadcast_to(radius, depth.shape)
            at = contacts(law, depth, size)
            area_slope = law.area_slope(at.contact_radius, size)
            slope = area_slope.sum(axis=1) / at.stiffness.sum(axis=1)
            if not self.radii.continuous:
                by_radius = np.zeros(depth.shape)
            elif law.similar:
                by_radius = 2.0 * at.area - depth * area_slope
                by_radius -= slope[:, None] * (2.0 * at.load - depth * at.stiffness)
            else:
                low, high = (contacts(law, depth, size * (1.0 + step)) for step in (-RELATIVE, RELATIVE))
                by_radius = (high.area - low.area) / (2.0 * RELATIVE)
                by_radius -= slope[:, None] * (high.load - low.load) / (2.0 * RELATIVE)
            return np.hstack([found.gradient, by_radius / self.depth])

        return residual


@dataclass(frozen=True, kw_only=True)
class OfExponents(Asperities):
    """Heights and exponents of power caps of one radius: the second unknowns are ``depth ln n``."""

    range: PowerRange
    radius: float
    depth: float

    def joined(self, height: FloatArray, shape: FloatArray) -> FloatArray:
        """Return the unknowns (2n,) [mm] for heights [mm] and exponents, (n,) each."""
        return np.concatenate([height, self.depth * np.log(shape)])

    def split(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the heights [mm] and the allowed exponents for unknowns (2n,), (n,) each."""
        height, logarithm = _halves(unknowns)
        return height, np.clip(np.exp(logarithm / self.depth), self.range.low, self.range.high)

    def _drawn(self, rng: np.random.Generator, count: int) -> FloatArray:
        return np.exp(rng.uniform(math.log(self.range.low), math.log(self.range.high), count))

    def residual(self, model: Independent, target: TargetLaw) -> Residual:
        """Return the residual of independent asperities as a function of the unknowns.

        With ``a = R (d/(c K R))^(1/n)`` and ``P = 2 n/(n + 1) a d`` at the indentation d, d ln a/dn is
        ``-(ln(a/R) + K'/K)/n`` and d ln P/dn is this plus 1/(n (n + 1)). At a fixed load,
        ``dA0/dn_i = dA_i/dn - dP_i/dn sum A' / sum P'``.
        """

        def residual(unknowns: FloatArray) -> LateResidual:
            height, n = self.split(unknowns)
            logarithm, turn = power_logarithms(n, self.range.coefficient, self.radius)
            depth = power_depths(height.max() - height, n, logarithm, target.load)
            closed = depth > 0.0
            rest = np.log(np.where(closed, depth, 1.0))
            a = np.exp(logarithm + rest / n) * closed
            area = math.pi * a**2

            def gradient() -> FloatArray:
                growth = 2.0 / n * area / np.where(closed, depth, 1.0)
                ratio = (growth.sum(axis=1) / (2.0 * a).sum(axis=1))[:, None]
                wider = turn - rest / n**2  # d ln a/dn
                by_load = 2.0 * n / (n + 1.0) * a * depth * (wider + 1.0 / (n * (n + 1.0)))
                by_exponent = 2.0 * area * wider - ratio * by_load
                return np.hstack([growth - ratio * 2.0 * a, by_exponent * (n / self.depth)])

            return target.late_residual(area.sum(axis=1), gradient)

        return residual


def power_depths(
    gap: FloatArray, exponent: FloatArray, logarithm: FloatArray, load: FloatArray
) -> FloatArray:
    """Return the indentations (k, n) [mm] of independent power caps at loads (k,); minus the gap if open.

    The contact radius is ``a = b d^(1/n)`` and the load ``2 n/(n + 1) a d``. logarithm: ln b.
    """
    n, first = exponent, int(gap.argmin())
    share = n / (n + 1.0)
    # upper bound: the tallest cap carries the load by itself
    x = np.exp((np.log(0.5 * load / share[first]) - logarithm[first]) * share[first])
    for step in range(MOST_NEWTON):
        depth = x[:, None] - gap
        closed = depth > 0.0
        a = np.exp(logarithm + np.log(np.where(closed, depth, 1.0)) / n) * closed
        half, slope = (a * depth) @ share, a.sum(axis=1)
        # first steps for logarithms, exact for one exponent without gaps; then Newton's method, which
        # converges from any side, as the load is a convex function of the approach
        new = x * (0.5 * load / half) ** (half / (x * slope)) if step < 3 else x + (0.5 * load - half) / slope
        change, x = np.abs(new - x), new
        if (change <= SETTLED * x).all():
            break
    return np.asarray(x[:, None] - gap)


@dataclass(frozen=True, kw_only=True)
class OfTools(Asperities):
    """Heights and tools: the second unknowns are the indices of the tools, which change at random only.

    `summits` is what the contact law takes as `radius` for each tool.
    """

    summits: Any

    def joined(self, height: FloatArray, shape: FloatArray) -> FloatArray:
        """Return the unknowns (2n,) for heights [mm] and indices of tools, (n,) each."""
        return np.concatenate([height, shape])

    def split(self, unknowns: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the heights [mm] and the indices of the tools for unknowns (2n,), (n,) each."""
        return _halves(unknowns)

    def _drawn(self, rng: np.random.Generator, count: int) -> FloatArray:
        return rng.integers(len(self.summits), size=count).astype(np.float64)

    def residual(self, model: Independent, target: TargetLaw) -> Residual:
        """Return the residual of independent asperities as a function of the unknowns."""

        def residual(unknowns: FloatArray) -> LateResidual:
            height, which = self.split(unknowns)
            try:
                found = model.sensitivity_of(height, self.summits[which.astype(np.int64)], target.load)
            except InvalidInput:
                return beyond(target.load, unknowns)
            return target.late_residual(
                found.curve.area, lambda: np.hstack([found.gradient, np.zeros_like(found.gradient)])
            )

        return residual
