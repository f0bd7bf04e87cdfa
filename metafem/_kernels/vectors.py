"""Sums over long vectors, in one thread: a threaded BLAS waits for cores that others use."""

from __future__ import annotations

from metafem._kernels.compiled import compiled


@compiled
def dot(a, b):
    """Return the inner product, four partial sums at a time."""
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
