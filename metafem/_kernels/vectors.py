"""Operations on vectors and small matrices in one thread, since a threaded BLAS may wait for busy cores."""

from __future__ import annotations

from functools import partial

from metafem._kernels.compiled import compiled


@partial(compiled, any_order=True)
def dot(a, b):
    """Return the inner product of a and the leading elements of b."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * b[i]
    return total


@partial(compiled, any_order=True)
def total_of(a):
    """Return the sum of a."""
    total = 0.0
    for i in range(a.size):
        total += a[i]
    return total


@compiled
def largest(a):
    """Return the largest number in a, or 0 if all are negative."""
    most = 0.0
    for i in range(a.size):
        most = a[i] if a[i] > most else most
    return most


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
