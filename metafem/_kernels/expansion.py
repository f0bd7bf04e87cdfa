"""Products with the coefficients of pairwise expansions."""

from __future__ import annotations

from numba import njit


@njit(cache=True, nogil=True)
def apply_pairs(first, second, order, start, table, moments, result):
    """Add each pair's block to its first patch, and the block's transpose to its second.

    moments, result: (m, s, s); a pair of order q uses the leading (q, q) of each. Its block is
    table[start:start + q^4], rows for the first patch and columns for the second.
    """
    for k in range(first.size):
        i = first[k]
        j = second[k]
        q = order[k]
        at = start[k]
        for a in range(q):
            for b in range(q):
                total = 0.0
                source = moments[i, a, b]
                for c in range(q):
                    for d in range(q):
                        value = table[at]
                        at += 1
                        total += value * moments[j, c, d]
                        result[j, c, d] += value * source
                result[i, a, b] += total
