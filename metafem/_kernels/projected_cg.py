"""Projected conjugate gradients for a Newton step with a fixed total load.

Solves ``A y - x 1 = b`` and ``sum y = total`` for the loads y of the contacts and the approach x. The
preconditioner consists of the diagonal and the constraint (Gould, Hribar and Nocedal, SIAM J. Sci. Comput.
23, 1376 (2001), doi:10.1137/S1064827598345667). The projection removes the stiff long-wave modes that only
change the approach. Without the constraint, x = 0. The set of contacts is fixed here, whereas
`models.boundary_elements.quadratic_program` also determines this set.
"""

from __future__ import annotations

import numpy as np

from metafem._kernels.compiled import compiled
from metafem._kernels.coupling import add_rows

# Maximum number of steps, sufficient for any well-posed dense system. The next Newton step corrects an
# inexact solution.
MAX_STEPS = 400


@compiled
def solve(matrix, diagonal, closed, count, free, total, rhs, tolerance, warm, y, work):
    """Fill y; return x, and whether the curvature of A was positive in all search directions.

    matrix: rows of A for the contacts, without `diagonal` (n,), which is added to the diagonal of A. free:
    whether the constraint applies. warm: whether y is an initial guess that satisfies the constraint. work:
    (4, n); on return its first row is ``rhs - A y`` for all asperities, including open ones. For the
    contacts, this row plus x is within `tolerance`.
    """
    n = diagonal.size
    residual, inverse, direction, image = work[0], work[1], work[2], work[3]
    whole = 0.0
    for k in range(count):
        i = closed[k]
        inverse[i] = 1.0 / (diagonal[i] + matrix[i, i])
        if inverse[i] <= 0.0:
            return 0.0, False
        whole += inverse[i]
    for i in range(n):
        residual[i] = rhs[i]
    if not warm:
        y[:] = 0.0
        if free:
            for k in range(count):
                y[closed[k]] = inverse[closed[k]] * total / whole
    if warm or free:
        image[:] = 0.0
        add_rows(matrix, closed, count, y, image)
        for i in range(n):
            residual[i] -= image[i]
        for k in range(count):
            i = closed[k]
            residual[i] -= diagonal[i] * y[i]
    before = 0.0
    for step in range(MAX_STEPS + 1):
        shift = 0.0
        if free:
            for k in range(count):
                i = closed[k]
                shift += inverse[i] * residual[i]
            shift /= whole
        product = largest = 0.0
        for k in range(count):
            i = closed[k]
            r = residual[i] - shift
            product += inverse[i] * r * r
            largest = max(largest, abs(r))
        if largest <= tolerance or step == MAX_STEPS:
            break
        ratio = product / before if before > 0.0 else 0.0
        before = product
        image[:] = 0.0
        for k in range(count):
            i = closed[k]
            last = ratio * direction[i] if step > 0 else 0.0
            direction[i] = inverse[i] * (residual[i] - shift) + last
        add_rows(matrix, closed, count, direction, image)
        bend = 0.0
        for k in range(count):
            i = closed[k]
            image[i] += diagonal[i] * direction[i]
            bend += direction[i] * image[i]
        if bend <= 0.0:
            return -shift, False
        length = product / bend
        for k in range(count):
            y[closed[k]] += length * direction[closed[k]]
        for i in range(n):
            residual[i] -= length * image[i]
    return -shift, True


def empty_work(count: int) -> np.ndarray:
    """Return the scratch array of `solve`."""
    return np.zeros((4, count))
