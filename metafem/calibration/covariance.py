"""Covariance matrices: given ones are checked, and those of functions of the parameters follow from them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from metafem import _validate as check
from metafem._given import shown
from metafem._validate import FloatArray
from metafem.errors import refuse_if

# Largest asymmetry and most negative eigenvalue of a correlation matrix that rounded input may cause.
ASYMMETRY = 1e-6


def checked_covariance(names: Sequence[str], covariance: ArrayLike) -> FloatArray:
    """Return the covariance matrix of named parameters, (p, p), or raise InvalidInput if it is invalid."""
    matrix = check.array("covariance", covariance, shape=(len(names), len(names)))
    # check the correlation matrix, which has no units
    scale = np.sqrt(np.abs(np.diagonal(matrix)))
    scaled = matrix / np.outer(*[np.where(scale > 0.0, scale, 1.0)] * 2)
    symmetric = np.allclose(scaled, scaled.T, rtol=0.0, atol=ASYMMETRY)
    refuse_if(
        not symmetric or np.linalg.eigvalsh(scaled).min() < -ASYMMETRY,
        f"covariance = {shown(matrix.tolist())} of {', '.join(names)} must be symmetric and positive "
        "semidefinite",
    )
    return matrix


def propagated(covariance: FloatArray, *rows: Sequence[ArrayLike]) -> FloatArray:
    """Return ``J C J^T`` for covariances C (..., p, p) and the rows of the Jacobian matrix J."""
    entries = [np.stack(np.broadcast_arrays(*row, covariance[..., 0, 0])[:-1], axis=-1) for row in rows]
    jacobian = np.stack(entries, axis=-2)
    return np.asarray(jacobian @ covariance @ np.swapaxes(jacobian, -1, -2))
