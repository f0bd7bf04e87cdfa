"""Operations on vectors and small matrices in one thread, since a threaded BLAS may wait for busy cores."""

from __future__ import annotations

from metafem._kernels.compiled import compiled


@compiled
def dot(a, b):
    """Return the inner product of a and the leading elements of b, computed as four partial sums."""
    s0 = s1 = s2 = s3 = 0.0
    whole = a.size - a.size % 4
    for i in range(0, whole, 4):
        s0 += a[i] * b[i]
        s1 += a[i + 1] * b[i + 1]
        s2 += a[i + 2] * b[i + 2]
        s3 += a[i + 3] * b[i + 3]
    for i in range(whole, a.size):
        s0 += a[i] * b[i]
    return (s0 + s1) + (s2 + s3)


@compiled
def total_of(a):
    """Return the sum of a, computed as four partial sums."""
    s0 = s1 = s2 = s3 = 0.0
    whole = a.size - a.size % 4
    for i in range(0, whole, 4):
        s0 += a[i]
        s1 += a[i + 1]
        s2 += a[i + 2]
        s3 += a[i + 3]
    for i in range(whole, a.size):
        s0 += a[i]
    return (s0 + s1) + (s2 + s3)


@compiled
def largest(a):
    """Return the largest number in a, or 0 if all are negative."""
    s0 = s1 = s2 = s3 = 0.0
    whole = a.size - a.size % 4
    for i in range(0, whole, 4):
        s0 = a[i] if a[i] > s0 else s0
        s1 = a[i + 1] if a[i + 1] > s1 else s1
        s2 = a[i + 2] if a[i + 2] > s2 else s2
        s3 = a[i + 3] if a[i + 3] > s3 else s3
    for i in range(whole, a.size):
        s0 = a[i] if a[i] > s0 else s0
    return max(max(s0, s1), max(s2, s3))


@compiled
def add(total, rest, term):
    """Return a sum and its rounding error after adding a term: Neumaier, ZAMM 54, 39 (1974)."""
    new = total + term
    return new, rest + ((total - new) + term if total >= term else (term - new) + total)


@compiled
def exact_sum(values):
    """Return the sum of an array, exact to a few roundings of the result."""
    total = rest = 0.0
    for value in values:
        total, rest = add(total, rest, value)
    return total + rest
