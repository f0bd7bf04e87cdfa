"""Laws of many asperities from sums of closed forms: independent, or coupled as point loads.

Loads are P/E* [mm^2], areas are in mm^2.
"""

from __future__ import annotations

import numpy as np

from validation.methods.caps import Caps

# Largest number of Newton steps, and relative error of the load at which they end.
STEPS, ROUNDING = 200, 4e-15


def independent(caps: Caps, height: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return areas (..., k) of independent asperities, of heights (..., n), at loads (k,)."""
    return np.asarray(np.pi * (contact_radii(caps, height, load) ** 2).sum(axis=-1))


def contact_radii(caps: Caps, height: np.ndarray, load: np.ndarray) -> np.ndarray:
    """Return the contact radii (..., k, n) [mm] of independent asperities.

    The total load is a convex function of the approach, so Newton's method converges from above.
    """
    gap = (height.max(axis=-1, keepdims=True) - height)[..., None, :]
    caps = Caps(*(np.asarray(each)[..., None, :] for each in vars(caps).values()))
    approach = np.full((*height.shape[:-1], len(load), 1), 1e-3)
    while (low := caps.pressed(approach - gap)[1].sum(axis=-1) < load).any():
        approach[low] *= 2.0
    for _ in range(STEPS):
        a, each = caps.pressed(approach - gap)
        step = (each.sum(axis=-1) - load) / (2.0 * a.sum(axis=-1))
        approach -= np.where(step > ROUNDING * approach[..., 0], step, 0.0)[..., None]
        if (step <= ROUNDING * approach[..., 0]).all():
            break
    return caps.pressed(approach - gap)[0]


def coupled(
    caps: Caps, height: np.ndarray, load: np.ndarray, influence: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return areas and loads (k, n) of asperities that act on each other as point loads (order 1).

    The indentations d, negative over a gap, and the approach x solve ``d + K P(d) = x - gap`` and
    ``sum P(d) = p``; `influence` is K, (n, n), with its regular part on the diagonal.
    """
    gap, n = height.max() - height, len(height)
    unknown, areas, loads = np.append(1e-3 - gap, 1e-3), [], []

    def equations(u: np.ndarray, p: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        a, each = caps.pressed(u[:n])
        return np.append(u[:n] + influence @ each - u[n] + gap, each.sum() - p), a, each

    for p in load:
        while caps.pressed(unknown[:n])[1].sum() < 0.5 * p:  # begin with contacts that carry about this load
            unknown += 0.2 * abs(unknown[n]) + 1e-4
        residual, a, each = equations(unknown, p)
        for _ in range(STEPS):
            matrix = np.ones((n + 1, n + 1))
            matrix[:n, :n] = np.eye(n) + influence * (2.0 * a)
            matrix[:n, n], matrix[n, :n], matrix[n, n] = -1.0, 2.0 * a, 0.0
            step = np.linalg.solve(matrix, residual)
            size = 1.0
            while size > 1e-6:
                trial = equations(unknown - size * step, p)
                if np.linalg.norm(trial[0]) < (1.0 - 0.1 * size) * np.linalg.norm(residual):
                    break
                size *= 0.5
            else:  # rounding
                break
            unknown, (residual, a, each) = unknown - size * step, trial
        if np.abs(residual).max() > 1e-9 * max(p, abs(unknown[n])):
            raise ArithmeticError(f"the coupled contacts did not converge at the load P/E* = {p:g} mm^2")
        areas.append(np.pi * a**2)
        loads.append(each)
    return np.array(areas), np.array(loads)
