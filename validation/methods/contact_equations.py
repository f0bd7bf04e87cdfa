"""Elastic contacts of a surface that interact as point loads, by plain numpy."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

import metafem.reference as reference
from validation.methods.caps import Caps, FloatArray, approach_at

# Most steps of Newton's method, of which the loads of the paper need about six, the least part of a step, and
# the largest residual over load or approach at the end.
STEPS, LEAST, SMALL = 200, 1e-6, 1e-13


class Contacts(NamedTuple):
    """Separation [mm] and area A0 [mm²]."""

    separation: float
    area: float


def coupled(height: FloatArray, caps: Caps | float, influence: FloatArray, load: float) -> Contacts:
    """Return contacts of caps, or of paraboloids of a radius, that act as point loads on each other.

    d_i + sum_j K_ij P_j(d_j) = h_i - delta and sum_i P_i = P, by Newton's method in all unknowns. `influence`
    is K (n, n) per unit of P/E* [1/mm].
    """
    shape, n = caps if isinstance(caps, Caps) else Caps(caps), len(height)
    start = float(height.max()) - approach_at(shape, height, load)
    unknown = np.append(height - start, start)

    def equations(u: FloatArray) -> tuple[FloatArray, FloatArray]:
        a, force = shape.pressed(u[:n])
        return np.append(u[:n] + influence @ force - height + u[n], force.sum() - load), a

    residual, a = equations(unknown)
    for _ in range(STEPS):
        slope = np.ones((n + 1, n + 1))
        slope[:n, :n] = np.eye(n) + influence * (2.0 * a)
        slope[n] = np.append(2.0 * a, 0.0)
        step, size = np.linalg.solve(slope, residual), 1.0
        while np.linalg.norm((trial := equations(unknown - size * step))[0]) >= np.linalg.norm(residual):
            size *= 0.5
            if size < LEAST:  # rounding
                break
        else:
            unknown, (residual, a) = unknown - size * step, trial
            continue
        break
    if np.abs(residual).max() > SMALL * max(load, float(np.ptp(height)), float(np.abs(unknown).max())):
        raise ArithmeticError(f"Newton's method ends with a residual of {np.abs(residual).max():.2g}")
    return Contacts(float(unknown[n]), float(np.pi * (a**2).sum()))


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
    values = reference.layer_regular(different, surface.block.thickness, surface.material.poisson_ratio)
    with np.errstate(divide="ignore"):
        values = values + np.where(different > 0.0, 1.0 / (np.pi * different), 0.0)
    return np.asarray(values[index].reshape(distance.shape))
