"""Sparse symmetric factorisation that says how well it solved."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.sparse.linalg import splu

from metafem._validate import FloatArray

# Relative residual above which a factorisation is repeated with pivoting: 1e5 times what rounding costs,
# and far below what the elements do.
RESIDUAL_LIMIT = 1e-9


def solve(matrix: Any, right: FloatArray) -> tuple[FloatArray, float]:
    """Solve for all right-hand sides (n, m) with one factorisation; return the residual as well.

    The residual is ``max |A x - b| / max |b|``, recomputed on what is returned: the better of two tries
    where neither is below `RESIDUAL_LIMIT`, infinite where both fail.
    """
    solution, residual = np.zeros_like(right), 0.0 if not right.any() else math.inf
    attempts: tuple[dict[str, Any], ...] = (
        # symmetric, without pivoting: five times as fast as the default
        {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}},
        {"permc_spec": "COLAMD", "diag_pivot_thresh": 1.0},
    )
    for settings in attempts:
        if residual <= RESIDUAL_LIMIT:
            break
        try:
            candidate = splu(matrix, **settings).solve(right)
        except RuntimeError:  # a pivot of exactly zero
            continue
        error = float(np.abs(matrix @ candidate - right).max() / np.abs(right).max())
        if error < residual:
            solution, residual = candidate, error
    return solution, residual
