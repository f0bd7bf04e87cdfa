"""Sparse symmetric linear systems: fast factorisation with a check, and full pivoting if it fails."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any

import numpy as np
from scipy.sparse import diags
from scipy.sparse.linalg import splu

from metafem._validate import FloatArray

# Largest scaled residual of an accurate solution after refinement. A good factorisation reaches about 1e-15;
# one with a small pivot ends orders of magnitude higher.
RESIDUAL = 1e-10

# Pivot threshold for mixed elements whose pressures are not eliminated: the diagonal is zero for nu = 0.5.
THRESHOLD = 1e-3

# Number of refinement steps. Each step gains as many digits as the factors have; accurate factors need one
# step.
STEPS = 3


class LinearStatus(Enum):
    """How a linear system was solved; the value is the message."""

    CONVERGED = "converged: the factorisation's residual is at rounding"
    PIVOTED = "converged: the factorisation was repeated with pivoting"
    NOT_CONVERGED = "not converged: the factorisation's residual stays large with pivoting too"


@dataclass(frozen=True, eq=False)
class Solved:
    """Solution (n, k) of a system, its scaled residual (infinite for a singular matrix) and status."""

    value: FloatArray
    residual: float
    status: LinearStatus


def solve(matrix: Any, right: FloatArray, threshold: float = 0.0) -> Solved:
    """Return the solution of a sparse symmetric system for all columns of `right`, (n, k).

    Rows and columns are scaled by the square roots of the diagonal entries, or of their largest entries where
    the diagonal is zero. After elimination of the bubbles, the displacement and pressure blocks are definite
    with opposite signs. Such a quasi-definite matrix needs no pivoting in any order (Vanderbei, SIAM J.
    Optim. 5, 100 (1995), doi:10.1137/0805005). With a `threshold`, a diagonal pivot is used only if it
    exceeds this fraction of the largest entry of its column. If the residual is not small, the system is
    factorised again with full partial pivoting, and the solution with the smaller residual is returned.
    """
    size = np.abs(matrix.diagonal())
    size = np.where(size > 0.0, size, np.abs(matrix).max(axis=0).toarray().ravel())
    scale = 1.0 / np.sqrt(np.where(size > 0.0, size, 1.0))
    scaled = (diags(scale) @ matrix @ diags(scale)).tocsc()
    target = scale[:, None] * right
    symmetric: dict[str, Any] = {"SymmetricMode": True}
    value, residual = _refined(
        lambda: splu(scaled, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=threshold, options=symmetric),
        scaled,
        target,
    )
    status = LinearStatus.CONVERGED
    if not residual <= RESIDUAL:
        value, residual = min(
            (_refined(lambda: splu(scaled), scaled, target), (value, residual)), key=lambda pair: pair[1]
        )
        status = LinearStatus.PIVOTED if residual <= RESIDUAL else LinearStatus.NOT_CONVERGED
    return Solved(scale[:, None] * value, residual, status)


def _refined(factorised: Callable[[], Any], matrix: Any, right: FloatArray) -> tuple[FloatArray, float]:
    """Return the refined solution and its largest residual, relative to each column of `right`."""
    size = np.abs(right).max(axis=0)
    size[size == 0.0] = 1.0
    try:
        factors = factorised()
    except RuntimeError:  # a pivot of exactly zero
        return np.zeros_like(right), math.inf
    value = factors.solve(right)
    for _ in range(STEPS):
        value = value + factors.solve(right - matrix @ value)
    residual = float((np.abs(right - matrix @ value).max(axis=0) / size).max())
    return value, residual if math.isfinite(residual) else math.inf
