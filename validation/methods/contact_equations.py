"""Hertz contacts of a surface by plain numpy: independent ones, and ones that interact as point loads."""

from __future__ import annotations

import numpy as np

from metafem.reference import bonded_layer
from validation.methods.independent import FloatArray, approaches, sums

# Steps of Newton's method, of which the loads of the paper need about six.
MOST_STEPS = 60

# Relative size of the last step of Newton's method, ten times rounding.
SMALL = 1e-14


def independent(height: FloatArray, radius: float, load: float) -> tuple[FloatArray, float]:
    """Return the indentations (n,), negative for open asperities, and the separation."""
    approach = float(approaches(height, np.array([load]), radius)[0])
    separation = float(height.max()) - approach
    return height - separation, separation


def coupled(
    height: FloatArray, radius: float, influence: FloatArray, load: float
) -> tuple[FloatArray, float]:
    """Return the indentations (n,) and the separation of contacts that act as point loads on each other.

    d_i + sum_j K_ij P_j(d_j) = h_i - delta and sum_i P_i = P, by Newton's method in all unknowns. `influence`
    is K (n, n) per unit of P/E* [1/mm].
    """
    indentation, separation = independent(height, radius, load)
    n = len(height)
    for _ in range(MOST_STEPS):
        force = loads(indentation, radius)
        rate = 2.0 * np.sqrt(radius * np.clip(indentation, 0.0, None))
        residual = np.append(indentation + influence @ force - height + separation, force.sum() - load)
        slope = np.ones((n + 1, n + 1))
        slope[:n, :n] = np.eye(n) + influence * rate
        slope[n] = np.append(rate, 0.0)
        step = np.linalg.solve(slope, residual)
        indentation, separation = indentation - step[:n], separation - step[n]
        if np.abs(step).max() <= SMALL * np.abs(indentation).max():
            return indentation, float(separation)
    raise ArithmeticError(f"Newton's method ends with a step of {np.abs(step).max():.2g} mm")


def loads(indentation: FloatArray, radius: float) -> FloatArray:
    """Return Hertz's loads 4/3 sqrt(R) d^(3/2) [mm²] per E*; 0 for open asperities."""
    return np.asarray(4.0 / 3.0 * np.sqrt(radius) * np.clip(indentation, 0.0, None) ** 1.5)


def area(indentation: FloatArray, radius: float) -> float:
    """Return the sum of Hertz's areas pi R d [mm²]."""
    return float(sums(indentation, radius)[0])


def half_space_influence(position: FloatArray) -> FloatArray:
    """Return the influence 1/(pi r) between sites on the half-space, 0 on the diagonal [1/mm]."""
    distance = np.linalg.norm(position[:, None] - position, axis=2)
    np.fill_diagonal(distance, np.inf)
    return np.asarray(1.0 / (np.pi * distance))


def layer_influence(position: FloatArray, thickness: float, poisson_ratio: float) -> FloatArray:
    """Return the influence between sites on the bonded layer, its regular part on the diagonal [1/mm].

    By quadrature of Hankel's integral for each pair.
    """
    distance = np.linalg.norm(position[:, None] - position, axis=2)
    different, index = np.unique(distance.round(9), return_inverse=True)
    values = bonded_layer.regular_influence(different, thickness, poisson_ratio)
    with np.errstate(divide="ignore"):
        values = values + np.where(different > 0.0, 1.0 / (np.pi * different), 0.0)
    return np.asarray(values[index].reshape(distance.shape))
