"""Target law at a list of loads, possibly with free parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg.lapack import dgels

from metafem._validate import FloatArray, IntArray
from metafem.inversion.search.spaces import LateResidual

# Number of iterations for the free parameters. The weights of each iteration are relative to the law of the
# previous iteration. After two iterations the weights have converged to within a digit of the residual.
ROUNDS = 3

# If the nearest law is not positive, it is raised to at least this fraction of the area curve, which makes
# the differences large.
FAR = 0.1


@dataclass(frozen=True, eq=False)
class TargetLaw:
    """Target law ``base + free @ c`` at loads (k,), with free parameters c (q,), and weights."""

    load: FloatArray  # (k,) P/E* [mm^2], increasing
    base: FloatArray  # (k,), fixed part of F/(sigma B) [mm^2]
    free: FloatArray  # (k, q), factors of the free parameters
    weight: FloatArray  # (k,), weights of the squared relative differences, of mean 1
    # whether the misfit is the largest relative difference (True) or the root mean square (False)
    pointwise: bool = False
    noise: float = 0.0  # weighted root mean square of the relative errors of the law itself
    # lowest and highest law (k,) each [mm^2] of a band, with the middle as `base`; None for one law
    ends: tuple[FloatArray, FloatArray] | None = None

    @classmethod
    def fixed(
        cls,
        load: FloatArray,
        friction: FloatArray,
        weight: FloatArray | None = None,
        pointwise: bool = False,
        noise: float = 0.0,
    ) -> TargetLaw:
        """Return a law without free parameters."""
        given = np.ones(len(load)) if weight is None else weight
        return cls(load, friction, np.empty((len(load), 0)), given / given.mean(), pointwise, noise)

    def thinned(self, most: int) -> TargetLaw:
        """Return the law at no more than `most` of its loads, evenly spaced by index and with both ends."""
        count = len(self.load)
        if count <= most:
            return self
        part = self.part(np.unique(np.linspace(0, count - 1, most).round().astype(np.int64)))
        return replace(part, weight=part.weight / part.weight.mean())

    def part(self, rows: IntArray) -> TargetLaw:
        """Return the law at some of its loads, with their weights."""
        given = self.load[rows], self.base[rows], self.free[rows], self.weight[rows]
        ends = None if self.ends is None else (self.ends[0][rows], self.ends[1][rows])
        return TargetLaw(*given, self.pointwise, self.noise, ends)

    @property
    def is_open(self) -> bool:
        """Whether the target has free parameters."""
        return bool(self.free.shape[1])

    def open_parameters(self, area: FloatArray) -> FloatArray:
        """Return the free parameters for which the law is nearest to an area curve (k,) [mm^2], (q,)."""
        return np.asarray(np.linalg.lstsq(self.free, self.law(area) - self.base, rcond=None)[0])

    def law(self, area: FloatArray) -> FloatArray:
        """Return the target law with the free parameters nearest to an area curve, (k,) [mm^2].

        Of a band it is the nearest law within the band.
        """
        if self.ends is not None:
            return np.clip(area, *self.ends)
        if not self.is_open:
            return self.base
        law = area
        for _ in range(ROUNDS):
            scale = np.sqrt(self.weight) / law
            c = _nearest(scale[:, None] * self.free, scale * (area - self.base))
            law = self.base + self.free @ c
            if law.min() <= 0.0:  # the curve is far from any law of this kind
                return np.asarray(np.maximum(law, FAR * area))
        return np.asarray(law)

    def laws(self, area: FloatArray) -> FloatArray:
        """Return `law` for each of many area curves (m, k), by one call of the QR decomposition, (m, k)."""
        if self.ends is not None:
            return np.clip(area, *self.ends)
        law = np.array(area if self.is_open else np.broadcast_to(self.base, area.shape))
        near = np.full(len(area), self.is_open)
        for _ in range(ROUNDS if self.is_open else 0):
            scale = np.sqrt(self.weight) / law[near]
            q, r = np.linalg.qr(scale[:, :, None] * self.free)
            right = np.einsum("mkq,mk->mq", q, scale * (area[near] - self.base))
            c = np.linalg.solve(r, right[:, :, None])[:, :, 0]
            found = self.base + np.einsum("kq,mq->mk", self.free, c)
            far = found.min(axis=1) <= 0.0
            law[near] = np.where(far[:, None], np.maximum(found, FAR * area[near]), found)
            near[near] = ~far
        return law

    def residual(self, area: FloatArray, gradient: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the weighted relative differences (k,) [-] and their Jacobian (k, n) [1/mm].

        Both are those for the best free parameters.
        """
        residual, jacobian = self.late_residual(area, lambda: gradient)
        return residual, jacobian()

    def late_residual(self, area: FloatArray, gradient: Callable[[], FloatArray]) -> LateResidual:
        """Return the differences of `residual` (k,) [-], and a function that returns their Jacobian."""
        law = self.law(area)
        scale = np.sqrt(self.weight) / law
        residual = scale * (area - law)

        if self.ends is not None:  # within the band the law may change freely
            scale = np.where(residual == 0.0, 0.0, scale)

        def without_open(values: FloatArray) -> FloatArray:
            if not self.is_open:
                return values
            free = scale[:, None] * self.free
            return np.asarray(values - free @ _nearest(free, values))

        return without_open(residual), lambda: without_open(scale[:, None] * gradient())

    def misfit(self, area: FloatArray) -> float:
        """Return the weighted root mean square of the relative differences [-]."""
        return float(np.sqrt((self.weight * self.difference(area) ** 2).mean()))

    def difference(self, area: FloatArray) -> FloatArray:
        """Return the relative differences of an area curve from the law, (k,) [-]."""
        return np.asarray(area / self.law(area) - 1.0)


def _nearest(free: FloatArray, values: FloatArray) -> FloatArray:
    """Return the coefficients (q, ...) for which a sum of columns (k, q) is nearest to values (k, ...)."""
    count = free.shape[1]
    if len(free) < count:
        return np.asarray(np.linalg.lstsq(free, values, rcond=None)[0])
    _, found, failed = dgels(free, values)  # a fifth of the time of `lstsq`
    if failed:  # linearly dependent columns
        return np.asarray(np.linalg.lstsq(free, values, rcond=None)[0])
    return np.asarray(found[:count])
