"""Products of the expansions of pairs of patches."""

import numpy as np

from metafem._kernels.expansion import apply_pairs


def test_blocks_act_both_ways():
    rng = np.random.default_rng(0)
    first, second, order = np.array([0, 0, 1]), np.array([1, 2, 2]), np.array([3, 2, 1])
    start = np.concatenate([[0], np.cumsum(order**4)])
    table, moments = rng.standard_normal(start[-1]), rng.standard_normal((3, 3, 3))
    result = np.zeros_like(moments)
    apply_pairs(first, second, order, start, table, moments, result)
    plain = np.zeros_like(moments)
    for k, (i, j, q) in enumerate(zip(first, second, order, strict=True)):
        block = table[start[k] : start[k + 1]].reshape(q, q, q, q)
        plain[i, :q, :q] += np.einsum("abcd,cd", block, moments[j, :q, :q])
        plain[j, :q, :q] += np.einsum("abcd,ab", block, moments[i, :q, :q])
    np.testing.assert_allclose(result, plain, rtol=1e-12, atol=1e-13)
