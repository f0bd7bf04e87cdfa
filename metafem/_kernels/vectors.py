"""Operations on vectors and small matrices in one thread, since a threaded BLAS may wait for busy cores."""

from __future__ import annotations

import math

from metafem._kernels.compiled import compiled


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


@compiled
def factorise(matrix, count, column):
    """Replace a lower triangle by its Cholesky factor; return whether the matrix is positive definite."""
    for k in range(count):
        if not matrix[k, k] > 0.0:
            return False
        root = math.sqrt(matrix[k, k])
        for m in range(k, count):
            matrix[m, k] /= root
            column[m] = matrix[m, k]
        matrix[k, k] = root
        for m in range(k + 1, count):
            line, factor = matrix[m], column[m]
            for j in range(k + 1, m + 1):
                line[j] -= factor * column[j]
    return True


@compiled
def substitute(matrix, count, vector):
    """Replace a right-hand side by the solution, given the Cholesky factor in `matrix`."""
    for k in range(count):
        total = vector[k]
        for m in range(k):
            total -= matrix[k, m] * vector[m]
        vector[k] = total / matrix[k, k]
    for k in range(count - 1, -1, -1):
        vector[k] /= matrix[k, k]
        for m in range(k):
            vector[m] -= matrix[k, m] * vector[k]
