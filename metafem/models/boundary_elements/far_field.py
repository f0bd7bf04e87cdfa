"""Displacement of one patch by the pressure on another, computed by Chebyshev expansions.

Between two separate boxes the influence is smooth, and is expanded in tensor Chebyshev polynomials:
``G(|x - y|) = sum C_kl T_k(x) T_l(y)``, where C is computed from values at Chebyshev nodes. The far field of
a patch then depends only on its q^2 Chebyshev moments. With q terms per side the error is about rate^-q,
where the rate is the parameter of the Bernstein ellipse through the nearest singularity. The regular part of
a layer has its singularities farther away than 1/r, so the same order is sufficient for all substrates. The
result equals the sum over all pairs of cells within `TOLERANCE`.

Trefethen, Approximation Theory and Approximation Practice (2020), theorem 8.2, doi:10.1137/1.9781611975949;
Fong and Darve, J. Comput. Phys. 228, 8712 (2009), doi:10.1016/j.jcp.2009.08.031.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from metafem._kernels.expansion import apply_pairs
from metafem._validate import FloatArray, IntArray

# Largest estimated relative error of the influence between two patches. The estimate is conservative:
# measured errors of sums over all cells were below 3e-10.
TOLERANCE = 1e-8

# Number of coefficients that are computed at once: those of a few pairs, within the cache.
BATCH = 2**16

# Offset [cells] of two points along each side of a cell. The points represent a cell of side 1/sqrt(2) and
# are used for both source and target. The influence then remains symmetric and equals Love's far field, G +
# h^2/24 lap G, to fourth order.
HALF_SPREAD = 1.0 / math.sqrt(24.0)


def convergence_rate(centre: FloatArray, half: FloatArray) -> FloatArray:
    """Return the factor by which each additional term reduces the error between boxes, (m, m).

    centre, half: centres and half widths, (m, 2). Along each axis of the target, the nearest singularity is
    determined by the distance to the source box: its real part along the axis, its imaginary part across it.
    """
    apart = np.abs(centre[:, None, :] - centre[None, :, :])
    along = np.maximum(apart - half[None, :, :], 0.0)
    across = np.maximum(apart - half[:, None, :] - half[None, :, :], 0.0)[:, :, ::-1]
    z = (along + 1j * across) / half[:, None, :]
    rate = np.abs(z + np.sqrt(z - 1.0) * np.sqrt(z + 1.0))
    worst = rate.min(axis=2)
    return np.asarray(np.minimum(worst, worst.T))


def orders(rate: FloatArray) -> IntArray:
    """Return the number of terms q per side for which rate^-q is below the tolerance."""
    return np.asarray(np.ceil(math.log(1.0 / TOLERANCE) / np.log(rate)).astype(np.int64) + 1)


def table_bytes(rate: FloatArray) -> int:
    """Return the memory that the expansions between pairs with these rates need [bytes]."""
    return int(8 * (orders(rate).astype(np.float64) ** 4).sum())


class FarField:
    """Expansions between all pairs of patches.

    influence: displacement [cells] by unit pressure p/E* on one cell, as a function of the distance [cells].
    centre: centres of the patches, (m, 2) [cells]; shape: rows and columns of each patch.
    """

    def __init__(
        self,
        influence: Callable[[FloatArray], FloatArray],
        centre: FloatArray,
        shape: list[tuple[int, int]],
    ) -> None:
        half = 0.5 * np.array(shape, dtype=np.float64)
        first, second = np.triu_indices(len(shape), 1)
        order = orders(convergence_rate(centre, half)[first, second])
        place = np.argsort(order, kind="stable")
        self.first, self.second, order = first[place], second[place], order[place]
        start = np.concatenate([[0], np.cumsum(order**4)])
        table = np.empty(start[-1])
        for a, b in _batches(order):
            i, j, q = self.first[a:b], self.second[a:b], int(order[a])
            block = _coefficients(influence, centre[i] - centre[j], half[i], half[j], q)
            table[start[a] : start[b]] = block.ravel()
        self.size = int(order.max(initial=1))
        self.shape = shape
        self.table: tuple[IntArray, IntArray, FloatArray] = (order, start, table)
        self.bases = {s: (_basis(s[0], self.size), _basis(s[1], self.size)) for s in set(shape)}

    def moments(self, pressure: FloatArray) -> FloatArray:
        """Return the Chebyshev moments of one patch, (size, size)."""
        x, y = self.bases[pressure.shape]
        return np.asarray(x.T @ pressure @ y)

    def local(self, moments: FloatArray) -> FloatArray:
        """Return the coefficients of each patch's displacement by the other patches, (m, size, size)."""
        result = np.zeros_like(moments)
        apply_pairs(self.first, self.second, *self.table, moments, result)
        return result

    def displacement(self, local: FloatArray, shape: tuple[int, int]) -> FloatArray:
        """Return the displacement of the cells of a patch from its coefficients."""
        x, y = self.bases[shape]
        return np.asarray(x @ local @ y.T)


def _basis(count: int, size: int) -> FloatArray:
    """Return Chebyshev polynomials along one side, averaged over each cell, (count, size)."""
    position = np.arange(count) - 0.5 * (count - 1)
    below, above = (chebvander(2.0 * (position + s) / count, size - 1) for s in (-HALF_SPREAD, HALF_SPREAD))
    return np.asarray(0.5 * (below + above))


def _batches(order: IntArray) -> Iterator[tuple[int, int]]:
    """Yield ranges of sorted orders with one value, whose tables together have about `BATCH` coefficients."""
    for q in np.unique(order).tolist():
        start, end = np.searchsorted(order, (q, q + 1)).tolist()
        step = max(1, BATCH // q**4)
        yield from ((k, min(k + step, end)) for k in range(start, end, step))


def _coefficients(
    influence: Callable[[FloatArray], FloatArray],
    apart: FloatArray,
    half_target: FloatArray,
    half_source: FloatArray,
    q: int,
) -> FloatArray:
    """Return the coefficients C of pairs, (m, q, q, q, q); the last two axes belong to the source."""
    node = np.cos(math.pi * (np.arange(q) + 0.5) / q)
    transform = (2.0 / q) * chebvander(node, q - 1).T
    transform[0] *= 0.5
    dx, dy = (
        apart[:, k, None, None]
        + half_target[:, k, None, None] * node[:, None]
        - half_source[:, k, None, None] * node
        for k in range(2)
    )
    # Axes: pair, target x, target y, source x, source y.
    values = influence(np.hypot(dx[:, :, None, :, None], dy[:, None, :, None, :]))
    for _ in range(4):
        values = np.tensordot(values, transform, axes=(1, 1))
    return np.asarray(values)
