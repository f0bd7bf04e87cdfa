"""Sparse symmetric linear systems: fast factorisation with a check, and full pivoting if it fails."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.sparse import diags_array
from scipy.sparse.linalg import splu

from metafem._validate import FloatArray, IntArray
from metafem.errors import NotConverged

# Largest scaled residual of an accurate solution after refinement. A good factorisation reaches about 1e-15;
# one with a small pivot ends orders of magnitude higher.
RESIDUAL = 1e-10

# Largest number of solutions with one factorisation, and the scaled residual, about rounding, at which they
# end. Each gains as many digits as the factors have; accurate factors need two.
STEPS, ROUNDING = 4, 1e-14


def solve(
    matrix: Any, fixed: IntArray, value: FloatArray, load: FloatArray | None = None, threshold: float = 0.0
) -> tuple[FloatArray, float]:
    """Return the solution of a sparse symmetric system for all columns of `load`, (n, k), and its residual.

    The unknowns `fixed` keep their `value`, (n, k); the load of the others is 0 by default.

    Rows and columns are scaled by the square roots of the diagonal entries, or of their largest entries where
    the diagonal is zero. After elimination of the bubbles, the displacement and pressure blocks are definite
    with opposite signs. Such a quasi-definite matrix needs no pivoting in any order (Vanderbei, SIAM J.
    Optim. 5, 100 (1995), doi:10.1137/0805005). With a `threshold`, a diagonal pivot is used only if it
    exceeds this fraction of the largest entry of its column. If the residual is not small, the system is
    factorised again with full partial pivoting. If it stays large, NotConverged is raised.
    """
    free, result = np.setdiff1d(np.arange(len(value)), fixed), np.zeros(value.shape)
    result[fixed] = value[fixed]
    rows = matrix[free]
    right = -(rows @ result) if load is None else load[free] - rows @ result
    inner = rows[:, free]
    size = np.abs(inner.diagonal())
    size = np.where(size > 0.0, size, np.abs(inner).max(axis=0).toarray().ravel())
    scale = diags_array(1.0 / np.sqrt(np.where(size > 0.0, size, 1.0)))
    scaled, target = (scale @ inner @ scale).tocsc(), scale @ right
    unit = np.maximum(np.abs(target).max(axis=0), np.finfo(float).tiny)
    symmetric = {
        "permc_spec": "MMD_AT_PLUS_A",
        "diag_pivot_thresh": threshold,
        "options": {"SymmetricMode": True},
    }
    residual = math.inf
    for options in (symmetric, {}):
        try:
            factors = splu(scaled, **options)
        except RuntimeError:  # a pivot of exactly zero
            continue
        solution, rest = np.zeros_like(target), target
        for _ in range(STEPS):
            solution += factors.solve(rest)
            rest = target - scaled @ solution
            residual = float((np.abs(rest).max(axis=0) / unit).max())
            if residual <= ROUNDING:
                break
        if residual <= RESIDUAL:
            result[free] = scale @ solution
            return result, residual
    raise NotConverged(f"the linear system keeps a residual of {residual:.1e} with full pivoting")
