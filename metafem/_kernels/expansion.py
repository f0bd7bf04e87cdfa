"""Products with the coefficients of pairwise expansions."""

from __future__ import annotations

import numpy as np

from metafem._kernels.compiled import compiled


@compiled
def apply_pairs(first, second, order, start, table, moments, result):
    """Add each pair's block times the second's moments to its first patch, and the transpose's back.

    moments, result: (m, s, s); a pair of order q uses the leading (q, q) of each. Its block is
    table[start:start + q^4], rows for the first patch and columns for the second.
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
        whole = square - square % 4
        at = start[k]
        for a in range(q):
            for b in range(q):
                own = moments[i, a, b]
                row = table[at : at + square]
                at += square
                s0 = s1 = s2 = s3 = 0.0
                for c in range(0, whole, 4):
                    s0 += row[c] * source[c]
                    s1 += row[c + 1] * source[c + 1]
                    s2 += row[c + 2] * source[c + 2]
                    s3 += row[c + 3] * source[c + 3]
                for c in range(whole, square):
                    s0 += row[c] * source[c]
                result[i, a, b] += (s0 + s1) + (s2 + s3)
                for c in range(square):
                    back[c] += own * row[c]
        for c in range(q):
            for d in range(q):
                result[j, c, d] += back[c * q + d]
