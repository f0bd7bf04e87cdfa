"""Products with the coefficients of expansions between pairs of patches."""

from __future__ import annotations

import numpy as np

from metafem._kernels.compiled import compiled
from metafem._kernels.vectors import dot


@compiled
def apply_pairs(first, second, order, start, table, moments, result):
    """Add the products of the block of each pair with the moments of its two patches to `result`.

    The block times the moments of the second patch is added to the first patch, and the transposed block
    times the moments of the first patch to the second. moments, result: (m, s, s); a pair of order q uses the
    leading (q, q) entries of each. Its block is table[start:start + q^4], with rows for the first patch and
    columns for the second.
    """
    size = moments.shape[1] * moments.shape[2]
    source = np.empty(size)
    back = np.empty(size)
    for k in range(first.size):
        i = first[k]
        j = second[k]
        q = order[k]
        square = q * q
        for c in range(q):
            for d in range(q):
                source[c * q + d] = moments[j, c, d]
        back[:square] = 0.0
        at = start[k]
        for a in range(q):
            for b in range(q):
                moment = moments[i, a, b]
                row = table[at : at + square]
                at += square
                result[i, a, b] += dot(row, source)
                for c in range(square):
                    back[c] += moment * row[c]
        for c in range(q):
            for d in range(q):
                result[j, c, d] += back[c * q + d]
