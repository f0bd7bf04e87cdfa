"""Hertz contacts of a surface by plain numpy: independent ones, and ones that interact as point loads."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from metafem.reference import bonded_layer
from validation.methods.independent import FloatArray, approaches, sums

# Steps of Newton's method, of which the loads of the paper need about six, and the relative size of the last
# one, ten times rounding.
MOST_STEPS, SMALL = 60, 1e-14


class Contacts(NamedTuple):
    """Indentations (n,) [mm], negative for open asperities, separation [mm], and area A0 [mm²]."""

    indentation: FloatArray
    separation: float
    area: float


def independent(height: FloatArray, radius: float, load: float) -> Contacts:
    """Return the contacts of independent asperities."""
    approach = float(approaches(height, np.array([load]), radius)[0])
    separation = float(height.max()) - approach
    return Contacts(height - separation, separation, float(sums(height - separation, radius)[0]))


def coupled(height: FloatArray, radius: float, influence: FloatArray, load: float) -> Contacts:
    """Return contacts that act as point loads on each other.

    d_i + sum_j K_ij P_j(d_j) = h_i - delta and sum_i P_i = P, by Newton's method in all unknowns. `influence`
    is K (n, n) per unit of P/E* [1/mm].
    """
    indentation, separation, _ = independent(height, radius, load)
    n = len(height)
    for _ in range(MOST_STEPS):
        depth = np.clip(indentation, 0.0, None)
        force, rate = 4.0 / 3.0 * np.sqrt(radius) * depth**1.5, 2.0 * np.sqrt(radius * depth)
        residual = np.append(indentation + influence @ force - height + separation, force.sum() - load)
        slope = np.ones((n + 1, n + 1))
        slope[:n, :n] = np.eye(n) + influence * rate
        slope[n] = np.append(rate, 0.0)
        step = np.linalg.solve(slope, residual)
        indentation, separation = indentation - step[:n], separation - step[n]
        if np.abs(step).max() <= SMALL * np.abs(indentation).max():
            return Contacts(indentation, float(separation), float(sums(indentation, radius)[0]))
    raise ArithmeticError(f"Newton's method ends with a step of {np.abs(step).max():.2g} mm")


def influence(surface: Any, substrate: str) -> FloatArray:
    """Return the influence between the sites of a surface on a "half-space" or its "layer" [1/mm].

    On the half-space 1/(pi r) with 0 on the diagonal; on the bonded layer by quadrature of Hankel's integral
    for each pair, with the regular part on the diagonal.
    """
    distance = np.linalg.norm(surface.position[:, None] - surface.position, axis=2)
    if substrate == "half-space":
        np.fill_diagonal(distance, np.inf)
        return np.asarray(1.0 / (np.pi * distance))
    different, index = np.unique(distance.round(9), return_inverse=True)
    values = bonded_layer.regular_influence(
        different, surface.block.thickness, surface.material.poisson_ratio
    )
    with np.errstate(divide="ignore"):
        values = values + np.where(different > 0.0, 1.0 / (np.pi * different), 0.0)
    return np.asarray(values[index].reshape(distance.shape))
