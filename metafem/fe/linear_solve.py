"""Sparse symmetric systems: a fast factorisation, checked, with a careful one behind it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csc_matrix, diags
from scipy.sparse.linalg import SuperLU, splu

from metafem._validate import FloatArray

# Largest scaled residual that refinement can leave when the factors are sound: a good factorisation
# ends near 1e-15, one that met a small pivot orders of magnitude above.
RESIDUAL = 1e-10

# Refinement steps: each gains the digits that the factors have; sound ones need one.
STEPS = 3


@dataclass(frozen=True, eq=False)
class Solved:
    """Solution of a system, its scaled residual, and whether pivoting was needed."""

    value: FloatArray
    residual: float
    pivoted: bool


def solve(matrix: csc_matrix, right: FloatArray, threshold: float = 0.0) -> Solved:
    """Solve the symmetric system for all columns of `right`, (n, k).

    Rows and columns are scaled by the roots of the diagonal, or of their largest entry where it is zero.
    Where the elements' bubbles have been eliminated before, definite displacements are left over definite
    pressures of the other sign: a quasi-definite matrix, which needs no pivoting in any order (Vanderbei,
    SIAM J. Optim. 5, 100 (1995), doi:10.1137/0805005). A `threshold` takes a diagonal pivot only if it is
    that share of its column. Where the residual is not small, the system is factorised again with full
    partial pivoting.
    """
    diagonal = np.abs(matrix.diagonal())
    largest = np.abs(matrix).max(axis=0).toarray().ravel()
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, largest))
    scaled = (diags(scale) @ matrix @ diags(scale)).tocsc()
    target = scale[:, None] * right
    result = _refined(_symmetric(scaled, threshold), scaled, target)
    pivoted = not result[1] <= RESIDUAL
    if pivoted:
        result = _refined(splu(scaled), scaled, target)
    return Solved(scale[:, None] * result[0], result[1], pivoted)


def _symmetric(matrix: csc_matrix, threshold: float) -> SuperLU:
    return splu(
        matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=threshold, options={"SymmetricMode": True}
    )


def _refined(factors: SuperLU, matrix: csc_matrix, right: FloatArray) -> tuple[FloatArray, float]:
    """Return the solution after refinement and its largest residual, relative to each column."""
    size = np.abs(right).max(axis=0)
    size[size == 0.0] = 1.0
    value = factors.solve(right)
    for _ in range(STEPS):
        rest = right - matrix @ value
        value = value + factors.solve(rest)
    return value, float((np.abs(right - matrix @ value).max(axis=0) / size).max())
