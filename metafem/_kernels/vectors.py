"""Sums over vectors in one thread; a threaded BLAS may wait for cores that are in use."""

from __future__ import annotations

from metafem._kernels.compiled import compiled


@compiled
def dot(a, b):
    """Return the inner product of a with the first elements of b, by four partial sums."""
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
def add(total, rest, term):
    """Add a term to a sum and its rounding error, after Neumaier, ZAMM 54, 39 (1974)."""
    new = total + term
    return new, rest + ((total - new) + term if total >= term else (term - new) + total)


@compiled
def violations(w, face):
    """Return the largest |w| on the face, and the largest overlap -w elsewhere."""
    inside = 0.0
    outside = 0.0
    for i in range(w.size):
        if face[i]:
            inside = max(inside, abs(w[i]))
        else:
            outside = max(outside, -w[i])
    return inside, outside
